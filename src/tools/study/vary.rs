//! Factors with their levels: crossed, or together.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};

use super::factor_level::FactorForm;
use super::{Factor, FactorLevel, FlagFactor, factor};
use world::schema_of_form;

/// Factors and their levels, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vary(pub Vec<(Factor, Vec<FactorLevel>)>);

/// One level of each of some factors.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Case(pub Vec<(Factor, FactorLevel)>);

impl Case {
    /// Returns the level of a factor.
    pub(super) fn level(&self, flag: FlagFactor) -> Option<&FactorLevel> {
        let mut levels = self.0.iter();
        let found = levels.find(|(factor, _)| *factor == Factor::Flag(flag));
        found.map(|(_, level)| level)
    }

    /// Returns these levels with those of another case, which replace levels of the same factors.
    pub(super) fn joined_with(&self, other: &Self) -> Self {
        let mut joined = self.clone();
        for (factor, level) in &other.0 {
            match joined.0.iter_mut().find(|(known, _)| known == factor) {
                Some((_, known)) => *known = level.clone(),
                None => joined.0.push((factor.clone(), level.clone())),
            }
        }
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
        let factors = d
            .deserialize_map(FactorsVisitor(FactorForm::One))?
            .into_iter();
        let one = |(factor, levels): (Factor, Vec<FactorLevel>)| {
            Some((factor, levels.into_iter().next()?))
        };
        Ok(Self(factors.filter_map(one).collect()))
    }
}

struct FactorsVisitor(FactorForm);

impl<'de> Visitor<'de> for FactorsVisitor {
    type Value = Vec<(Factor, Vec<FactorLevel>)>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self.0 {
            FactorForm::List => "lists by name, such as { threads: [1, 2] }",
            FactorForm::One => "values by name, such as { threads: 1, image_size: [512, 512] }",
        })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut factors = Vec::new();
        while let Some(factor) = map.next_key::<Factor>()? {
            let levels = factor.next_levels(&mut map, self.0)?;
            factors.push((factor, levels));
        }
        Ok(factors)
    }
}
