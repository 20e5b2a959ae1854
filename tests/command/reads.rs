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
