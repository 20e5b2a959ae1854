//! What a run says of what it read.

use crate::shared::{Scratch, summary};

const ROWS: &str = "0.62,0.89\n0.77,0.22\n0.31,0.87\n0.25,0.82\n0.79,0.46\n0.31,0.27\n";

/// The first line, what is warned of, and the same in the summary.
#[test]
fn the_first_line_says_what_was_read() {
    let scratch = Scratch::new();
    scratch.file(
        "a.csv",
        &format!("id,x [m],y [m]\n{}", ROWS.lines().map(|row| format!("t,{row}\n")).collect::<String>()),
    );
    let frames: String = ROWS.lines().enumerate().map(|(j, row)| format!("{},{row}\n", j.div_ceil(3))).collect();
    scratch.file("frames.csv", &format!("frame,x,y\n{frames}"));
    scratch.file("numbered.csv", &format!("0,1\n{ROWS}"));
    scratch.file("flat.csv", &format!("x,y,z\n{}", ROWS.lines().map(|row| format!("{row},0\n")).collect::<String>()));
    let utm: Vec<u8> = (0..64u32)
        .flat_map(|j| [5e5 + (j * 37 % 64) as f32, 4_649_800.0 + (j % 8 * 8) as f32])
        .flat_map(f32::to_le_bytes)
        .collect();
    std::fs::write(scratch.path("utm.bin"), utm).unwrap();
    for (arguments, first, warning) in [
        (
            "a.csv --window 0,1,0,2",
            "n = 6, K = 1, 2D, window [0, 1] x [0, 2]; a.csv: text, header in line 1, columns x [m], y [m] (not used: id); each file is one realization",
            "",
        ),
        (
            "frames.csv --realization-column frame",
            "n = 1..3, K = 3, 2D, unit torus; frames.csv: text, header in line 1, columns x, y; realizations told apart by column frame",
            "",
        ),
        (
            "frames.csv",
            "n = 6, K = 1, 2D, unit torus; frames.csv: text, header in line 1, columns x, y (not used: frame); each file is one realization",
            "frames.csv:1: column frame has 3 values and was not used: 6 points are one realization; --realization-column frame makes each value one",
        ),
        (
            "numbered.csv --box 2,3",
            "n = 6, K = 1, 2D, torus of sides 2, 3; numbered.csv: text, header in line 1, columns 1, 2; each file is one realization",
            "numbered.csv:1: the first line, 0,1, was taken for the numbers of the columns, not for a point; written as 0.0,1.0 it is a point",
        ),
        (
            "flat.csv",
            "n = 6, K = 1, 3D, unit torus; flat.csv: text, header in line 1, columns x, y, z; each file is one realization",
            "every z is 0, and the points are measured in 3D all the same; --columns x,y leaves z out",
        ),
        (
            "a.csv --box 0.5,1 --wrap",
            "n = 6, K = 1, 2D, torus of sides 0.5, 1; a.csv: text, header in line 1, columns x [m], y [m] (not used: id); each file is one realization",
            "3 of 6 points were outside the box and folded into it",
        ),
        (
            "utm.bin --raw f32x2 --window 499999,500101,4649775,4649877",
            "n = 64, K = 1, 2D, window [499999, 500101] x [4649775, 4649877]; utm.bin: raw f32x2, columns 1, 2; each file is one realization",
            "coordinates are 32-bit floats: x in steps of 0.031, y in steps of 0.5, beside a mean distance to the nearest neighbour of about 6.4; store them as 64-bit floats, or subtract an offset before rounding",
        ),
        ("--sampler jittered -n 16 -k 3", "n = 16, K = 3, 2D, unit torus; sampler jittered, n 16, K 3, seed 1", ""),
    ] {
        let output = scratch.run(&format!("analyze {arguments} --stats neighbors --device cpu --out o --force"));
        let (out, errors) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        assert_eq!(out.lines().next(), Some(first), "{arguments}: {errors}");
        let said = errors.lines().any(|line| line.strip_prefix("warning: ") == Some(warning));
        assert!(said || warning.is_empty(), "{arguments}: {errors}");
        let json = summary(&scratch.path("o"));
        let warned = json["warnings"]
            .as_array()
            .unwrap()
            .iter()
            .any(|w| pairwave::Setting::renamed(w.as_str().unwrap(), pairwave::Setting::flag) == warning);
        assert!(warned || warning.is_empty(), "{arguments}: {json}");
        let html = std::fs::read_to_string(scratch.path("o/report.html")).unwrap();
        assert!(html.contains(
            &warning.replace("--realization-column", "`realization_column`").replace("--columns", "`columns`")
        ));
        let input = &json["input"];
        match first.split_once(": ") {
            Some((_, words)) => assert!(words.starts_with(input["formats"][0].as_str().unwrap()), "{input}"),
            None => assert!(input.is_null(), "{input}"),
        }
        assert_eq!(input["wrapped"].as_u64(), arguments.contains("--wrap").then_some(3), "{input}");
    }
    // Nothing is said where nothing is to be said.
    let output = scratch.run("analyze frames.csv --stats neighbors --device cpu --out o --force --quiet");
    assert!(output.status.success() && output.stdout.is_empty() && output.stderr.is_empty(), "{output:?}");
    // A plan begins with it too.
    assert!(
        scratch.ok("analyze a.csv --device cpu --explain").starts_with("n = 6, K = 1, 2D, unit torus; a.csv: text, ")
    );
}

/// A row of six points, each with something behind it.
fn beside(column: impl Fn(usize) -> String) -> String {
    ROWS.lines().enumerate().map(|(j, row)| format!("{row},{}\n", column(j))).collect()
}

/// What was read otherwise than the first line says, or may be no coordinate, is warned of.
#[test]
fn what_may_be_meant_otherwise_is_a_warning() {
    let scratch = Scratch::new();
    scratch.file("a.csv", &format!("x,y\n{ROWS}"));
    scratch.file("swapped.csv", &format!("y,x,mark\n{}", beside(|j| j.to_string()).replace("0.62", "0.63")));
    scratch.file("bare.txt", &ROWS.replace("0.62", "0.64"));
    scratch.file("copy.csv", &format!("x,y\n{ROWS}"));
    std::fs::create_dir_all(scratch.path("all/old")).unwrap();
    std::fs::create_dir_all(scratch.path("all/new")).unwrap();
    scratch.file("all/a.csv", &format!("x,y\n{ROWS}"));
    let third = |name: &str, column: &dyn Fn(usize) -> String| scratch.file(name, &beside(column).repeat(2));
    third("interleaved.txt", &|j| (j % 2).to_string());
    third("class.txt", &|j| [0, 1, 1, 0, 1, 0][j].to_string());
    scratch.file("down.txt", &beside(|j| (9 - j).to_string()));
    scratch.file("depth.txt", &beside(|j| format!("{}.5", j % 2)));
    scratch.file("unit.csv", &format!("x [deg],y [deg]\n{ROWS}"));
    scratch.file("sign.txt", &format!("x [\u{b0}] y [\u{b0}]\n{}", ROWS.replace(',', " ")));
    scratch.file("words.csv", &format!("x (degrees),y (degrees)\n{ROWS}"));
    scratch.file("comment.txt", &format!("# lon lat\n# WGS84\n{}", ROWS.replace(',', " ")));
    scratch.file("heat.csv", &format!("x [degC],y [degC]\n{ROWS}"));
    let degrees = |place: &str, column: &str| {
        format!(
            "{place}: column {column} holds degrees by its name; distances in degrees differ with direction and latitude: convert to metres first (UTM or another projection)"
        )
    };
    let counted = |name: &str| {
        format!(
            "{name}:1: column 3 has 2 values, all whole, beside fractions, as classes and frames have, and was read as a coordinate; --columns 1,2 leaves it out, and --class-column 3 or --realization-column 3 says what it is"
        )
    };
    let table: [(&str, Option<String>); 12] = [
        (
            "a.csv swapped.csv",
            Some("swapped.csv: read as text, header in line 1, columns x, y (not used: mark), unlike the first file: text, header in line 1, columns x, y".into()),
        ),
        (
            "a.csv bare.txt",
            Some("bare.txt: read as text, columns 1, 2, unlike the first file: text, header in line 1, columns x, y".into()),
        ),
        (
            "a.csv copy.csv",
            Some("copy.csv has the same points as realization 0: realizations that are copies make standard errors too small".into()),
        ),
        ("all", Some("all: 2 folders within it were not read; give them as well, or 'all/*/*'".into())),
        ("interleaved.txt --box 1,1,2", Some(counted("interleaved.txt"))),
        ("class.txt --box 1,1,2", Some(counted("class.txt"))),
        (
            "down.txt --box 1,1,10",
            Some("down.txt:1: column 3 counts by -1 (9, 8, 7, ...) and was read as a coordinate; --columns 1,2 leaves it out".into()),
        ),
        ("unit.csv", Some(degrees("unit.csv:1", "x [deg]"))),
        ("sign.txt", Some(degrees("sign.txt:1", "x [\u{b0}]"))),
        ("words.csv", Some(degrees("words.csv:1", "x (degrees)"))),
        ("comment.txt", Some(degrees("comment.txt:3", "lon"))),
        ("heat.csv", None),
    ];
    for (arguments, warning) in table {
        let output = scratch.run(&format!("analyze {arguments} --stats neighbors --device cpu --out o --force"));
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{arguments}: {errors}");
        match warning {
            Some(warning) => {
                assert!(errors.lines().any(|l| l == format!("warning: {warning}")), "{arguments}: {errors}")
            }
            None => assert!(!errors.contains("warning"), "{arguments}: {errors}"),
        }
    }
    // Coordinates that are no whole numbers are nothing to warn of, whatever their number.
    let output = scratch.run("analyze depth.txt --box 1,1,2 --stats neighbors --device cpu --out o --force");
    assert!(!String::from_utf8(output.stderr).unwrap().contains("warning"));
}

/// Frequencies with other columns beside them, in any order, with names in a comment; the program's own list among them.
#[test]
fn what_was_read_of_frequencies_is_said() {
    let scratch = Scratch::new();
    scratch.file("a.csv", &format!("x,y\n{ROWS}"));
    scratch.file("m.csv", "id,m_y,note,m_x\n1,2,a b,1\n2,0,,3\n");
    scratch.file("nu.csv", "id,nu_x,nu_y\n1,0.5,1\n2,1.5,0\n");
    scratch.file("comment.txt", "# m_y m_x\n# made by hand\n2 1\n0 3\n");
    let run = |arguments: &str| {
        let out = scratch.ok(&format!("analyze a.csv {arguments} --stats spectrum --device cpu --out o --force"));
        let table = std::fs::read_to_string(scratch.path("o/spectrum_list.csv")).unwrap();
        (out.lines().nth(1).unwrap().to_string(), table)
    };
    let (line, torus) = run("--frequencies m.csv");
    assert_eq!(
        line,
        "frequencies m.csv: text, header in line 1, columns m_x, m_y (not used: id, note), 2 wave vectors in cycles per side"
    );
    assert!(torus.lines().nth(1).unwrap().starts_with("1,2,"), "{torus}");
    let (line, commented) = run("--frequencies comment.txt");
    assert_eq!(line, "frequencies comment.txt: text, columns m_x, m_y, 2 wave vectors in cycles per side");
    assert_eq!(commented, torus);
    let window = "--window 0,2,0,2";
    let (line, windowed) = run(&format!("{window} --frequencies nu.csv"));
    assert_eq!(
        line,
        "frequencies nu.csv: text, header in line 1, columns nu_x, nu_y (not used: id), 2 wave vectors in cycles per unit length"
    );
    // What the program writes it reads.
    for (table, domain) in [(torus, ""), (windowed, window)] {
        scratch.file("own.csv", &table);
        assert_eq!(run(&format!("{domain} --frequencies own.csv")).1, table);
    }
    let plan = scratch.ok("analyze a.csv --stats spectrum --frequencies m.csv --device cpu --explain");
    assert_eq!(plan.matches("frequencies m.csv: text").count(), 1, "{plan}");
}

/// A box that a file states is the domain, from its lower corner on, unless another is given.
#[test]
fn boxes_of_files_are_domains() {
    let scratch = Scratch::new();
    let points = |k: u32| (0..30u32).map(move |j| [j * 37 % 64, (j * j + k) * 11 % 64].map(|i| f64::from(i) / 16.0));
    let dump = |flags: &str| {
        let step = |k| {
            let rows: String = points(k).map(|[x, y]| format!("1 {} {} 0\n", x - 1.5, y + 2.0)).collect();
            format!(
                "ITEM: TIMESTEP\n{k}\nITEM: NUMBER OF ATOMS\n30\nITEM: BOX BOUNDS {flags}\n-1.5 2.5\n2 6\n-1 1\nITEM: ATOMS id x y z\n{rows}"
            )
        };
        (0..20).map(step).collect::<String>()
    };
    scratch.file("a.dump", &dump("pp pp pp"));
    scratch.file("walls.dump", &dump("ff sm pp"));
    let shifted = (0..20).map(|k| points(k).map(|[x, y]| format!("{x} {y}\n")).collect::<String>());
    scratch.file("a.txt", &shifted.collect::<Vec<_>>().join("#\n"));
    let tables = |arguments: &str| {
        scratch.ok(&format!("analyze {arguments} --stats pcf,spectrum,neighbors --device cpu --out o --force"));
        ["pcf.csv", "spectrum_radial.csv"].map(|name| std::fs::read_to_string(scratch.path("o").join(name)).unwrap())
    };
    let torus = tables("a.dump --columns x,y");
    assert_eq!(summary(&scratch.path("o"))["domain"]["origin"], serde_json::json!([-1.5, 2.0]));
    assert_eq!(torus, tables("a.txt --box 4,4"));
    let window = tables("walls.dump --columns x,y");
    assert_eq!(window, tables("a.txt --window 0,4,0,4"));
    assert_eq!(window, tables("a.dump --columns x,y --domain window"));
    assert_eq!(torus, tables("walls.dump --columns x,y --domain torus"));
    assert_ne!(window, torus);
    assert_ne!(torus, tables("a.dump --columns x,y --window -1.5,2.5,2,6"));
    // Sums know where the torus begins.
    scratch.ok("analyze a.dump --columns x,y --shard 1/2 --device cpu --out parts/1");
    scratch.ok("analyze a.dump --columns x,y --shard 2/2 --device cpu --out parts/2");
    scratch.ok("merge parts/1 parts/2 --out merged");
    assert_eq!(summary(&scratch.path("merged"))["domain"]["origin"], serde_json::json!([-1.5, 2.0]));
    for (arguments, said) in [
        (
            "walls.dump",
            "walls.dump: its box [-1.5, 2.5) x [2, 6) x [-1, 1) is periodic along some axes and not along others",
        ),
        ("a.dump a.xyz --columns x,y", "a.xyz: its box is not that of a.dump; --box or --window sets one for all"),
        (
            "tilted.xyz",
            "tilted.xyz: Lattice \"4 1 0 0 4 0 0 0 1\" is not orthogonal: y of vector 1 is 1; --window gives",
        ),
    ] {
        scratch.file("a.xyz", "1\nLattice=\"4 0 0 0 4 0 0 0 1\" Properties=pos:R:2\n1 2\n");
        scratch.file("tilted.xyz", "1\nLattice=\"4 1 0 0 4 0 0 0 1\" Properties=pos:R:2\n1 2\n");
        scratch.fails(&format!("analyze {arguments} --device cpu"), 1, said);
    }
    let flat = scratch.run("analyze a.dump --device cpu --stats neighbors");
    assert!(
        String::from_utf8(flat.stderr)
            .unwrap()
            .contains("every z is 0, and the points are measured in 3D all the same; --columns x,y leaves z out")
    );
}

/// What is read of a pipe is gone: nobody may look at how it begins first. A device may have no end.
#[cfg(unix)]
#[test]
fn pipes_are_read_once_and_devices_not() {
    let scratch = Scratch::new();
    scratch.ok("sample jittered -n 64 -k 4 --quiet --out batch.npy");
    scratch.ok("sample jittered -n 64 -k 1 --quiet --out one.csv");
    for (name, first) in [("one.csv", "n = 64, K = 1, "), ("batch.npy", "n = 64, K = 4, ")] {
        let bytes = std::fs::read(scratch.path(name)).unwrap();
        for arguments in ["-", "/dev/stdin", "/dev/stdin --keep-going"] {
            let line = format!("analyze {arguments} --device cpu --stats pcf");
            let output = scratch.command().args(line.split(' ')).write_stdin(bytes.clone()).output().unwrap();
            let (out, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
            assert!(output.status.success() && out.starts_with(first), "{line}: {out}{errors}");
        }
    }
    let endless = "/dev/zero: is a device, which may have no end; expected a file or a pipe";
    for arguments in [
        "analyze /dev/zero",
        "scan /dev/zero --out a.scan",
        "analyze one.csv --stats pcf --edges /dev/zero",
        "analyze one.csv --stats spectrum --frequencies /dev/zero",
        "analyze one.csv --window-polygon /dev/zero",
        "integrate one.csv --integrand image:file=/dev/zero",
        "integrate one.csv --integrand table:file=/dev/zero",
        "analyze --config /dev/zero",
        "merge /dev/zero --out merged",
    ] {
        scratch.fails(arguments, 1, endless);
    }
    scratch.fails("analyze /dev/null", 1, "/dev/null: the file is empty");
    scratch.fails("sample random -n 9 --out /dev/null --force", 2, "is a pipe or a device");
}
