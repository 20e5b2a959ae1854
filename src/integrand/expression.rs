//! Expressions of x, y and z: read here, so that what is wrong has a place, and evaluated by `exmex`.

use exmex::prelude::{Express, FlatEx};

use super::entry::AXES;
use crate::samplers::nearest_names;

/// Functions of one number that there are.
const FUNCTIONS: [&str; 26] = [
    "abs", "signum", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh",
    "floor", "round", "ceil", "trunc", "fract", "exp", "sqrt", "cbrt", "ln", "log2", "log10", "log",
];

/// Functions of two.
const OF_TWO: [&str; 3] = ["atan2", "min", "max"];

/// Names of numbers.
const CONSTANTS: [(&str, f64); 8] = [
    ("pi", std::f64::consts::PI),
    ("PI", std::f64::consts::PI),
    ("π", std::f64::consts::PI),
    ("tau", std::f64::consts::TAU),
    ("TAU", std::f64::consts::TAU),
    ("τ", std::f64::consts::TAU),
    ("e", std::f64::consts::E),
    ("E", std::f64::consts::E),
];

/// An expression made ready.
#[derive(Debug, Clone)]
pub(super) struct Expression {
    parsed: FlatEx<f64>,
    /// The axis of each variable it has.
    axes: Vec<usize>,
}

impl Expression {
    /// In words what is wrong and where, if anything is.
    pub(super) fn parse(text: &str, dim: usize) -> Result<Self, String> {
        let plain = Reader::new(text, dim).read()?;
        // What the reader lets through is an expression; should the two ever differ, this is said without a place.
        let parsed = exmex::parse::<f64>(&plain).map_err(|error| error.to_string())?;
        let axis = |name: &String| AXES.iter().position(|axis| axis == name).ok_or(format!("there is no {name}"));
        let axes = parsed.var_names().iter().map(axis).collect::<Result<_, _>>()?;
        Ok(Self { parsed, axes })
    }

    pub(super) fn value(&self, x: [f64; 3]) -> f64 {
        let mut given = [0.0; 3];
        self.axes.iter().zip(&mut given).for_each(|(axis, to)| *to = x[*axis]);
        self.parsed.eval(&given[..self.axes.len()]).unwrap_or(f64::NAN)
    }
}

/// What stands open.
struct Open {
    /// Where.
    at: usize,
    /// The function of two numbers whose arguments these are, and whether the comma between them is still to come.
    of_two: Option<(&'static str, bool)>,
    /// Whether the last operator outside was a power.
    after_power: bool,
}

/// Reads an expression once and writes it as `exmex` takes it: there a sign binds closer than a power, here -x^2 is -(x^2).
struct Reader<'a> {
    chars: Vec<char>,
    at: usize,
    dim: usize,
    text: &'a str,
    plain: String,
    open: Vec<Open>,
    /// The operator before the operand that is expected.
    operator: char,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str, dim: usize) -> Self {
        Self { chars: text.chars().collect(), at: 0, dim, text, plain: String::new(), open: Vec::new(), operator: '(' }
    }

    fn wrong(&self, at: usize, what: &str) -> String {
        match self.chars.get(at) {
            Some(c) => format!("character {} ({c}): {what}", at + 1),
            None => format!("it ends after character {}: {what}", self.chars.len()),
        }
    }

    fn peek(&mut self) -> Option<char> {
        while self.chars.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
        self.chars.get(self.at).copied()
    }

    fn read(mut self) -> Result<String, String> {
        loop {
            self.operand()?;
            if !self.operator()? {
                break;
            }
        }
        match self.open.last() {
            Some(open) => Err(self.wrong(open.at, "this parenthesis is not closed")),
            None => Ok(self.plain),
        }
    }

    /// Up to the end of a number or name, signs and open parentheses before it included.
    fn operand(&mut self) -> Result<(), String> {
        loop {
            let start = self.at;
            match self.peek() {
                Some('-') => {
                    self.plain += match self.operator {
                        '^' => "-",
                        '/' => "(-1)/",
                        _ => "(-1)*",
                    };
                    self.at += 1;
                }
                Some('+') => self.at += 1,
                Some('(') => self.opened(None),
                Some(c) if c.is_ascii_digit() || c == '.' => return self.number(),
                Some(c) if c.is_alphabetic() || c == '_' => {
                    if self.name()? {
                        return Ok(());
                    }
                }
                Some('*') if self.operator == '*' => return Err(self.wrong(self.at, "a power is written x^2")),
                _ => {
                    let at = self.at.max(start);
                    return Err(self.wrong(at, "expected a number, a coordinate, a function or a parenthesis"));
                }
            }
        }
    }

    /// `exmex` has functions of two numbers as operators between them: max(x, y) becomes ((x)max(y)).
    fn opened(&mut self, of_two: Option<&'static str>) {
        let of_two = of_two.map(|name| (name, true));
        self.plain += if of_two.is_some() { "((" } else { "(" };
        self.open.push(Open { at: self.at, of_two, after_power: self.operator == '^' });
        self.operator = '(';
        self.at += 1;
    }

    fn number(&mut self) -> Result<(), String> {
        let start = self.at;
        let digits = |reader: &mut Self| {
            while reader.chars.get(reader.at).is_some_and(|c| c.is_ascii_digit() || *c == '.') {
                reader.at += 1;
            }
        };
        digits(self);
        if matches!(self.chars.get(self.at), Some('e' | 'E')) {
            let sign = usize::from(matches!(self.chars.get(self.at + 1), Some('+' | '-')));
            if self.chars.get(self.at + 1 + sign).is_some_and(char::is_ascii_digit) {
                self.at += 1 + sign;
                digits(self);
            }
        }
        let typed: String = self.chars[start..self.at].iter().collect();
        let number: f64 = typed.parse().map_err(|_| self.wrong(start, &format!("{typed} is not a number")))?;
        if number.is_infinite() {
            return Err(self.wrong(start, &format!("{typed} is too large; numbers reach to 1e308")));
        }
        self.plain += &number.to_string();
        Ok(())
    }

    /// Whether it was an operand; else a function, whose argument follows.
    fn name(&mut self) -> Result<bool, String> {
        let start = self.at;
        while self.chars.get(self.at).is_some_and(|c| c.is_alphanumeric() || *c == '_') {
            self.at += 1;
        }
        let name: String = self.chars[start..self.at].iter().collect();
        if let Some(axis) = AXES.iter().position(|axis| *axis == name) {
            if axis >= self.dim {
                return Err(self.wrong(start, &format!("there is no {name} in {}D", self.dim)));
            }
            self.plain += &name;
            return Ok(true);
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|(constant, _)| *constant == name) {
            self.plain += &value.to_string();
            return Ok(true);
        }
        let of_two = OF_TWO.into_iter().find(|known| *known == name);
        if of_two.is_none() && !FUNCTIONS.contains(&name.as_str()) {
            let known: Vec<&str> = FUNCTIONS.iter().chain(&OF_TWO).copied().collect();
            let hint = nearest_names(&name, &known).map_or(String::new(), |near| format!(" (did you mean {near}?)"));
            let axes = AXES[..self.dim].join(", ");
            let reason = format!("no such name as {name}{hint}; expected {axes}, pi, e, tau, {}", known.join(", "));
            return Err(self.wrong(start, &reason));
        }
        if self.peek() != Some('(') {
            return Err(self.wrong(self.at, &format!("{name} needs its argument in parentheses")));
        }
        if of_two.is_none() {
            self.plain += &name;
        }
        self.opened(of_two);
        Ok(false)
    }

    /// Whether an operand follows.
    fn operator(&mut self) -> Result<bool, String> {
        loop {
            let Some(c) = self.peek() else { return Ok(false) };
            match c {
                '^' if self.operator == '^' => {
                    return Err(self.wrong(self.at, "a^b^c has two meanings; expected parentheses"));
                }
                '+' | '-' | '*' | '/' | '^' => {
                    self.plain.push(c);
                    self.operator = c;
                    self.at += 1;
                    return Ok(true);
                }
                ',' => {
                    if let Some(Open { of_two: Some((name, comma @ true)), .. }) = self.open.last_mut() {
                        *comma = false;
                        self.plain += &format!("){name}(");
                        self.operator = '(';
                        self.at += 1;
                        return Ok(true);
                    }
                    return Err(self.wrong(self.at, "a comma stands between the two arguments of a function only"));
                }
                ')' => match self.open.pop() {
                    None => return Err(self.wrong(self.at, "no parenthesis is open")),
                    Some(Open { of_two: Some((_, true)), .. }) => {
                        return Err(self.wrong(self.at, "expected a comma and a second argument"));
                    }
                    Some(open) => {
                        self.plain += if open.of_two.is_some() { "))" } else { ")" };
                        self.operator = if open.after_power { '^' } else { '(' };
                        self.at += 1;
                    }
                },
                _ => {
                    let reason = format!("expected an operator in {}", self.text);
                    return Err(self.wrong(self.at, &reason));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_mean_what_mathematics_says() {
        let (x, y, z) = (0.3f64, 0.7f64, 0.45f64);
        for (text, expected) in [
            ("x^2*y", x * x * y),
            ("-x^2", -(x * x)),
            ("exp(-x^2/2)", (-x * x / 2.0).exp()),
            ("2*-x^2", -2.0 * x * x),
            ("y/-x^2", -y / (x * x)),
            ("y/-x*z", -y / x * z),
            ("2^-x", 2f64.powf(-x)),
            ("--x", x),
            ("1 - -x", 1.0 + x),
            ("y - x^2", y - x * x),
            ("-(x+y)^2", -(x + y).powi(2)),
            ("sin(x)^2 + cos(x)^2", 1.0),
            ("2^(-x)^2", 0.0),
            ("max(x, min(y, z)) + atan2(y, -x)", x.max(y.min(z)) + y.atan2(-x)),
            ("1e-3 + .5 + 2. + 1E2*x", 0.001 + 0.5 + 2.0 + 100.0 * x),
            (
                "cos(2*pi*x) + e + tau - π",
                (2.0 * std::f64::consts::PI * x).cos() + std::f64::consts::E + std::f64::consts::PI,
            ),
            ("x-y-z", x - y - z),
            ("x/y/z", x / y / z),
            ("x/y*z", x / y * z),
            ("+x", x),
            ("3", 3.0),
            ("log2(x)+log10(x)+log(y)+ln(z)", x.log2() + x.log10() + y.ln() + z.ln()),
            ("asinh(x)*atan(y)-atanh(z)*tanh(y)", x.asinh() * y.atan() - z.atanh() * y.tanh()),
            ("min(min(x, y), max(y, z) - 1)^2", (x.min(y).min(y.max(z) - 1.0)).powi(2)),
            ("exp(-min(x,y)^2)/max(x,y)", (-x.min(y).powi(2)).exp() / x.max(y)),
            ("sqrt(abs(x - 0.5))*signum(y-z)", 0.2f64.sqrt()),
        ] {
            let parsed = Expression::parse(text, 3);
            if text == "2^(-x)^2" {
                assert!(parsed.unwrap_err().contains("two meanings"));
                continue;
            }
            let found = parsed.unwrap_or_else(|error| panic!("{text}: {error}")).value([x, y, z]);
            assert!((found - expected).abs() < 1e-14, "{text}: {found}, expected {expected}");
        }
    }

    #[test]
    fn what_is_wrong_has_a_place() {
        for (text, said) in [
            ("x +* y", "character 4 (*): expected a number"),
            ("2x", "character 2 (x): expected an operator"),
            ("x**2", "character 3 (*): a power is written x^2"),
            ("sin x", "character 5 (x): sin needs its argument"),
            ("(x + y", "character 1 ((): this parenthesis is not closed"),
            ("x + y)", "character 6 ()): no parenthesis is open"),
            ("x + ", "it ends after character 4: expected"),
            ("", "it ends after character 0: expected"),
            ("min(x)", "character 6 ()): expected a comma"),
            ("sin(x, y)", "character 6 (,): a comma stands"),
            ("siin(x)", "character 1 (s): no such name as siin (did you mean sin?)"),
            ("x + z", "character 5 (z): there is no z in 2D"),
            ("1.2.3", "character 1 (1): 1.2.3 is not a number"),
            ("x + 1e400", "character 5 (1): 1e400 is too large"),
            ("x^2^3", "character 4 (^): a^b^c has two meanings"),
            ("2^-x^2", "character 5 (^): a^b^c has two meanings"),
            ("x < 0.5", "character 3 (<): expected an operator"),
            ("()", "character 2 ()): expected a number"),
        ] {
            let error = Expression::parse(text, 2).unwrap_err();
            assert!(error.starts_with(said), "{text}: {error}");
        }
    }
}
