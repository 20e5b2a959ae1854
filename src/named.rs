//! Values with names: what a person types, and what files and messages hold.

/// Names the values of an enum, once for everything that reads or writes them. Values after the semicolon have a name, but
/// cannot be asked for.
macro_rules! named {
    ($type:ident: $($value:ident = $name:literal),+ $(; $($other:ident = $other_name:literal),+)?) => {
        impl $type {
            /// All values that can be asked for.
            pub const ALL: &[Self] = &[$(Self::$value),+];

            /// Its name, as typed.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $name,)+
                    $($(Self::$other => $other_name,)+)?
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, String> {
                let named = Self::ALL.iter().find(|value| value.name() == text).copied();
                named.ok_or_else(|| format!("expected one of {}", Self::ALL.iter().map(|v| v.name()).collect::<Vec<_>>().join(", ")))
            }
        }
    };
}

pub(crate) use named;
