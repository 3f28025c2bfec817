//! One value for each of the four components of a surface: reflection and transmission of either side.

use gonio_geom::{Component, Side};

/// Up to four values, one for each (side of incidence, component).
#[derive(Clone, Debug, PartialEq)]
pub struct FourComponents<T> {
    slots: [Option<T>; 4],
}

impl<T> Default for FourComponents<T> {
    fn default() -> Self {
        FourComponents {
            slots: [None, None, None, None],
        }
    }
}

/// Position of a component in [`FourComponents::KEYS`].
fn slot(side: Side, component: Component) -> usize {
    let back = usize::from(side == Side::Back);
    2 * back + usize::from(component == Component::Transmission)
}

impl<T> FourComponents<T> {
    /// The four components in the order of iteration.
    pub const KEYS: [(Side, Component); 4] = [
        (Side::Front, Component::Reflection),
        (Side::Front, Component::Transmission),
        (Side::Back, Component::Reflection),
        (Side::Back, Component::Transmission),
    ];

    /// The value for light that arrives on `side`, when there is one.
    pub fn get(&self, side: Side, component: Component) -> Option<&T> {
        self.slots[slot(side, component)].as_ref()
    }

    /// Sets or removes a value and returns the one it replaces.
    pub fn set(&mut self, side: Side, component: Component, value: Option<T>) -> Option<T> {
        std::mem::replace(&mut self.slots[slot(side, component)], value)
    }

    /// The values that are there, with their (side of incidence, component).
    pub fn iter(&self) -> impl Iterator<Item = (Side, Component, &T)> {
        Self::KEYS
            .into_iter()
            .zip(&self.slots)
            .filter_map(|((side, component), v)| v.as_ref().map(|v| (side, component, v)))
    }

    /// The same components with `f` applied to each value.
    pub fn map<U>(&self, mut f: impl FnMut(Side, Component, &T) -> U) -> FourComponents<U> {
        let mut out = FourComponents::default();
        for (side, component, v) in self.iter() {
            out.set(side, component, Some(f(side, component, v)));
        }
        out
    }

    /// Number of values that are there.
    pub fn len(&self) -> usize {
        self.slots.iter().flatten().count()
    }

    /// Whether no value is there.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_comes_back_under_its_own_component_only() {
        let mut four = FourComponents::default();
        assert!(four.is_empty());
        four.set(Side::Back, Component::Transmission, Some(7));
        for (side, component) in FourComponents::<i32>::KEYS {
            let want = ((side, component) == (Side::Back, Component::Transmission)).then_some(7);
            assert_eq!(four.get(side, component).copied(), want);
        }
        assert_eq!(four.len(), 1);
    }
}
