//! Parameters of a part as products of the parameters of the fit.

/// A factor of a [`Product`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Factor {
    /// Parameter `k` of the fit.
    Value(usize),
    /// One minus parameter `k` of the fit.
    Complement(usize),
}

/// `constant` times the factors: how a parameter of a part follows from those of the fit, such as the diffuse
/// reflectance `C (1 - S)` of a plastic.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// The constant.
    pub constant: f64,
    /// The factors.
    pub factors: Vec<Factor>,
}

impl Product {
    /// Parameter `k` itself.
    pub fn of(k: usize) -> Self {
        Product {
            constant: 1.0,
            factors: vec![Factor::Value(k)],
        }
    }

    /// Reads `a*b*(1-c)` with parameter names and numbers; `None` for an unknown name.
    pub fn parse(text: &str, names: &[&str]) -> Option<Self> {
        let mut product = Product {
            constant: 1.0,
            factors: Vec::new(),
        };
        let position = |name: &str| names.iter().position(|n| *n == name);
        for term in text.split('*').map(str::trim) {
            if let Some(name) = term.strip_prefix("(1-").and_then(|t| t.strip_suffix(')')) {
                product.factors.push(Factor::Complement(position(name.trim())?));
            } else if let Some(k) = position(term) {
                product.factors.push(Factor::Value(k));
            } else {
                product.constant *= term.parse::<f64>().ok()?;
            }
        }
        Some(product)
    }

    /// The value for parameters `q`.
    pub fn value(&self, q: &[f64]) -> f64 {
        self.factors
            .iter()
            .fold(self.constant, |v, f| v * factor(*f, q).0)
    }

    /// Derivative of [`Product::value`] by parameter `k`.
    pub fn derivative(&self, q: &[f64], k: usize) -> f64 {
        (0..self.factors.len())
            .map(|m| match self.factors[m] {
                Factor::Value(j) | Factor::Complement(j) if j != k => 0.0,
                own => {
                    let rest = (0..self.factors.len()).filter(|&n| n != m);
                    rest.fold(self.constant * factor(own, q).1, |v, n| {
                        v * factor(self.factors[n], q).0
                    })
                }
            })
            .sum()
    }

    /// Whether parameter `k` occurs in it.
    pub fn uses(&self, k: usize) -> bool {
        self.factors
            .iter()
            .any(|f| matches!(f, Factor::Value(j) | Factor::Complement(j) if *j == k))
    }
}

/// Value and slope of one factor.
fn factor(f: Factor, q: &[f64]) -> (f64, f64) {
    match f {
        Factor::Value(k) => (q[k], 1.0),
        Factor::Complement(k) => (1.0 - q[k], -1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_and_its_derivatives_are_those_of_the_text() {
        let product = Product::parse("2*C*(1-S)*C", &["C", "S"]).unwrap();
        let q = [0.7, 0.2];
        assert!((product.value(&q) - 2.0 * 0.49 * 0.8).abs() < 1e-15);
        assert!((product.derivative(&q, 0) - 4.0 * 0.7 * 0.8).abs() < 1e-15);
        assert!((product.derivative(&q, 1) + 2.0 * 0.49).abs() < 1e-15);
        assert!(product.uses(1) && !product.uses(2));
        assert_eq!(Product::parse("C*T", &["C", "S"]), None);
    }
}
