//! Factors with their levels: crossed, or together.

use std::fmt;

use indexmap::IndexMap;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::factor_level::FactorForm;
use super::{Factor, FlagFactor, factor};
use world::schema_of_form;

/// Factors and their levels, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Vary(pub IndexMap<Factor, Vec<Value>>);

/// One level of each of some factors.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Case(pub IndexMap<Factor, Value>);

impl Case {
    /// Returns the level of a factor.
    pub(super) fn level(&self, flag: FlagFactor) -> Option<&Value> {
        self.0.get(&Factor::Flag(flag))
    }

    /// Returns these levels with those of another case, which replace levels of the same factors.
    pub(super) fn joined_with(&self, other: &Self) -> Self {
        let mut joined = self.clone();
        joined.0.extend(other.0.clone());
        joined
    }
}

schema_of_form!(Vary, |g: &mut _| factor::schema::<Self>(
    FactorForm::List,
    g
));
schema_of_form!(Case, |g: &mut _| factor::schema::<Self>(FactorForm::One, g));

impl<'de> Deserialize<'de> for Vary {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_map(FactorsVisitor(FactorForm::List))
            .map(Self)
    }
}

impl<'de> Deserialize<'de> for Case {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let factors = d.deserialize_map(FactorsVisitor(FactorForm::One))?;
        let levels = factors.into_iter();
        let one =
            |(factor, levels): (Factor, Vec<Value>)| Some((factor, levels.into_iter().next()?));
        Ok(Self(levels.filter_map(one).collect()))
    }
}

struct FactorsVisitor(FactorForm);

impl<'de> Visitor<'de> for FactorsVisitor {
    type Value = IndexMap<Factor, Vec<Value>>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self.0 {
            FactorForm::List => "lists by name, such as { threads: [1, 2] }",
            FactorForm::One => "values by name, such as { threads: 1, image_size: [512, 512] }",
        })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut factors = IndexMap::new();
        while let Some(factor) = map.next_key::<Factor>()? {
            let levels = factor.next_levels(&mut map, self.0)?;
            factors.insert(factor, levels);
        }
        Ok(factors)
    }
}
