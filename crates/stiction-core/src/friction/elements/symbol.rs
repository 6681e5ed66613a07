//! What the literature calls a parameter: the symbol stands in its meaning, and whoever knows the
//! parameter by it is told its name.

use crate::friction::{LAWS, LawRecord};
use crate::support::parameter::ParameterSpec;

/// Letters that are written out where a keyboard lacks them.
const LETTERS: [(&str, &str); 12] = [
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("kappa", "κ"),
    ("lambda", "λ"),
    ("mu", "μ"),
    ("omega", "ω"),
    ("rho", "ρ"),
    ("sigma", "σ"),
    ("tau", "τ"),
    ("ell", "ℓ"),
];

impl ParameterSpec {
    /// The symbol in the meaning, as `σ_0` in "stiffness of the bristles, σ_0", where it has one.
    pub fn symbol(&self) -> Option<&'static str> {
        self.meaning.split(", ").skip(1).find_map(|clause| {
            let word = clause.split_whitespace().next()?.trim_end_matches([';', ':']);
            let whole = clause.len() == word.len()
                || clause[word.len()..].starts_with([';', ':'])
                || clause[word.len()..].trim_start().starts_with(['=', '<', '(']);
            let letters = word.chars().all(|c| c.is_alphanumeric() || c == '_');
            let short = word.chars().count() == 1 || word.contains('_');
            let begins = word.starts_with(char::is_alphabetic);
            (whole && letters && short && begins).then_some(word)
        })
    }
}

impl LawRecord {
    /// The parameter of this law that somebody means by a symbol, as `sigma0`, `Fs` or `F_s`.
    ///
    /// A symbol that other laws have for a parameter of the same name will do.
    pub fn called(&self, given: &str) -> Option<&'static ParameterSpec> {
        let wanted = plain(given);
        let named = |spec: &&ParameterSpec| spec.symbol().is_some_and(|own| plain(own) == wanted);
        self.parameters.iter().find(named).or_else(|| {
            let others = LAWS.iter().flat_map(|law| law.parameters).filter(named);
            let own = |name: &str| self.parameters.iter().find(|spec| spec.name == name);
            others.filter_map(|other| own(other.name)).next()
        })
    }
}

/// A symbol without what differs from text to text: case, underscores, the letter for an effort.
fn plain(symbol: &str) -> String {
    let mut text = symbol.to_lowercase();
    for (spelled, letter) in LETTERS {
        if let Some(rest) = text.strip_prefix(spelled) {
            text = format!("{letter}{rest}");
        }
    }
    text.retain(|c| c.is_alphanumeric());
    // Torques are F here, as forces are; angular speeds are v.
    let mut letters = text.chars();
    let (first, rest) = (letters.next(), letters.as_str());
    match (first, rest) {
        (Some('t' | 'm' | 'τ'), "c" | "s" | "v") => format!("f{rest}"),
        (Some('ω'), _) => format!("v{rest}"),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::law_record;

    #[test]
    fn symbols_of_the_literature_are_known() {
        let lugre = law_record("lugre").unwrap();
        for (given, name) in [
            ("sigma0", "initial_stiffness"),
            ("sigma_1", "damping"),
            ("σ2", "viscous"),
            ("Fv", "viscous"),
            ("Fc", "coulomb"),
            ("F_s", "breakaway"),
            ("Tc", "coulomb"),
            ("tau_s", "breakaway"),
            ("vs", "stribeck_velocity"),
            ("omega_s", "stribeck_velocity"),
            ("delta", "stribeck_exponent"),
        ] {
            assert_eq!(lugre.called(given).map(|spec| spec.name), Some(name), "{given}");
        }
        assert!(lugre.called("stiffness").is_none() && lugre.called("").is_none());
    }

    #[test]
    fn no_law_has_one_symbol_for_two_parameters() {
        for law in LAWS {
            let mut seen: Vec<_> =
                law.parameters.iter().filter_map(ParameterSpec::symbol).collect();
            let found = seen.len();
            seen.sort_unstable();
            seen.dedup();
            assert_eq!(found, seen.len(), "{}: {seen:?}", law.name);
            assert!(found > 0, "{}", law.name);
        }
    }
}
