//! The check of the `metrics` section.

use super::Config;
use super::array_check::lacks;
use crate::yaml::{Fault, FieldPath};
use base::Keyword;

impl Config {
    /// Checks the names of all metrics, and that a rendering with these settings has their arrays.
    ///
    /// # Errors
    /// The fault of the first wrong one.
    pub fn check_metrics(&self) -> Result<(), Fault> {
        for metric in self.metrics.list() {
            let path = || FieldPath::default().key("metrics").key(&metric.name);
            if let Some([message, expected]) = metric.name_fault() {
                return Err(Fault::at_key(path(), message, expected));
            }
            for part in metric.parts {
                if let Some([what, help]) = lacks(part, self) {
                    let name = part.name();
                    let message = format!("the metric `{}` requires {what}", metric.name);
                    let expected = format!("this rendering does not have `{name}`");
                    return Err(Fault::new(path(), message, expected).with_help(help));
                }
            }
        }
        Ok(())
    }
}
