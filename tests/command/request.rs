//! A request and its command line are one.

use clap::Args;
use pairwave::request::{Request, shell_words};

/// A request goes back to the line it was typed as; together the lines hold every flag and every word a flag takes.
#[test]
fn a_request_is_a_command_line() {
    let lines = [
        "--sampler jittered -n 100 -k 4 --dim 3 --seed 9 --param a=1 --param b=2 --domain torus --box 1,2.5,1e-7 --wrap --unit mm",
        "--raw f32x2 --weight-column w --class-column=-3 --domain window --window=-1,1,0,2 a.txt - b.txt",
        "--class-column 3 --classes A,B --stats pcf,radial,pcf-vector,k-function,covariance --edges e.txt x.npy",
        "--r-max 0.25 --bins 12 --bin-scale log --beyond-half --lag-bins 8 --lag-max 0.125 --lag-rings 0.1,0.2 x",
        "--kernel gaussian --bandwidth 0.001 --divisor d --exact-kernel --correction border --envelope 19 x",
        "--normalization intensity --max-frequency 3,4 --ring-directions 6 --sectors 4 --covariance-frequency 3 x",
        "--stats intensity,counts --intensity-bandwidth 0.125 --intensity-grid 64 x",
        "--inhomogeneous estimate x",
        "--intensity-column lambda x",
        "--frequencies f.txt --taper sine --tapers 3 --debias none --convention psa --bug-compatible x",
        "--integrand disk --integrand box:x0=0.1 --estimator ratio --shifts 4 --spatial radial --top 3 --intensity ramp --by warp x",
        "--window-polygon plot.wkt --keep-going --stats k-function x",
        "--columns x,y --realization-column frame --array pos --envelope-from s.npy --envelope-from t x.npz",
        "--r-max=-1 --bandwidth lscv --kernel box --device 0 --accuracy high --threads 2 --memory 4GiB --costs c.json -- x -y",
    ];
    let request = |arguments: &[String]| Request::parse(arguments.iter().cloned());
    let words = |line: &str| line.split(' ').map(str::to_string).collect::<Vec<_>>();
    let mut typed = Vec::new();
    for line in lines {
        let asked = request(&words(line)).unwrap();
        let (mut back, mut expected) = (asked.arguments(), words(line));
        assert_eq!(request(&back).unwrap(), asked, "{line}");
        assert_eq!(asked.command(), format!("pairwave analyze {}", back.join(" ")));
        typed.extend(back.iter().map(|word| word.split('=').next().unwrap().to_string()));
        back.sort();
        expected.sort();
        assert_eq!(back, expected);
    }
    for flag in Request::augment_args(clap::Command::new("")).get_arguments() {
        let Some(long) = flag.get_long().map(|long| format!("--{long}")) else { continue };
        let short = flag.get_short().map(|short| format!("-{short}"));
        assert!(typed.iter().any(|word| *word == long || Some(word) == short.as_ref()), "{long} is in no line");
        for value in flag.get_possible_values() {
            let mut line = words("--sampler random -n 2 --kernel box --integrand disk --intensity ramp");
            let value = value.get_name();
            let defaults = flag.get_default_values();
            match value {
                // A flag without a value.
                "true" | "false" => continue,
                _ if long == "--kernel" => line[5] = value.into(),
                _ => line.extend([long.clone(), value.into()]),
            }
            let asked = request(&line).unwrap();
            let back = asked.arguments();
            assert_eq!(request(&back).unwrap(), asked);
            assert_eq!(back.contains(&long), defaults != [value], "{long} {value}: {back:?}");
            assert!(defaults == [value] || back.iter().any(|word| word == value), "{long} {value}: {back:?}");
        }
    }

    assert_eq!(Request::default().command(), "pairwave analyze");
    assert_eq!(request(&words("--stats pcf,spectrum,neighbors --device auto")).unwrap(), Request::default());
    assert_eq!(shell_words(["a b", "it's", "", "x=1"]), r"'a b' 'it'\''s' '' x=1");
    for (line, said) in [
        ("--bins 1 --bins", "--bins 1 --bins: a value is required for '--bins <B>' but none was supplied"),
        ("--nonsense", "--nonsense: unexpected argument '--nonsense' found"),
        ("--bandwidth 1", "--bandwidth 1: the following required arguments were not provided: --kernel <KERNEL>"),
        (
            "--intensity-bandwidth lots",
            "--intensity-bandwidth lots: invalid value 'lots' for '--intensity-bandwidth <SD|RULE>': expected a number, scott or likelihood",
        ),
        ("--help", "--help: unexpected argument '--help' found"),
    ] {
        let error = request(&words(line)).unwrap_err();
        assert_eq!((error.to_string(), error.exit_code()), (format!("pairwave analyze {said}"), 2));
    }
}
