//! The cost metrics of a film.

use super::{Film, Strip};
use base::Keyword;
use tracer::cost::{Counter, Metric, MetricSource, RayKind, StepCounter, StepCounts};

impl Film {
    /// Overwrites `counts` with a counted metric of the pixels of a strip.
    pub fn counts(&self, strip: &Strip, metric: Metric, counts: &mut Vec<u32>) {
        counts.clear();
        match metric.source {
            MetricSource::Clock | MetricSource::Ratio(_) => counts.resize(strip.rgb.len(), 0),
            MetricSource::Noise | MetricSource::Efficiency => counts.resize(strip.rgb.len(), 0),
            MetricSource::Lanes | MetricSource::DeviceClock => counts.resize(strip.rgb.len(), 0),
            MetricSource::Counter(counter) => self.counter(strip, counter, counts),
            MetricSource::Observed(counter) => {
                let observed = strip.step_counts.iter();
                counts.extend(observed.map(|counts| counts[counter as usize]));
                counts.resize(strip.rgb.len(), 0);
            }
            MetricSource::AllRays => {
                counts.resize(strip.rgb.len(), self.n_samples);
                for counter in RayKind::ALL.map(Counter::rays) {
                    self.add_counts(strip, counter, counts);
                }
                self.clear_missing(strip, counts);
            }
        }
    }

    /// Keeps the steps of the rays of all pixels, row-major, row 0 on top.
    pub fn keep_step_counts(&mut self, all: Vec<StepCounts>) {
        let mut all = all.into_iter();
        for strip in &mut self.strips {
            strip.step_counts = all.by_ref().take(strip.rgb.len()).collect();
        }
    }

    /// Keeps the share of idle lanes of all pixels, row-major, row 0 on top, and the cycles and the
    /// multiprocessors of a device; empty where it does not say them.
    pub fn keep_idle_lanes(&mut self, idle_lanes: &[f32], cycles: &[f32], sms: &[i32]) {
        (self.extra.cycles, self.extra.sm) = (!cycles.is_empty(), !sms.is_empty());
        let mut first = 0;
        for strip in &mut self.strips {
            let pixels = first..first + strip.rgb.len();
            first = pixels.end;
            strip.idle_lanes = idle_lanes[pixels.clone()].to_vec();
            strip.cycles = cycles.get(pixels.clone()).unwrap_or_default().to_vec();
            strip.sm = sms.get(pixels).unwrap_or_default().to_vec();
        }
    }

    /// Returns the sum of a metric over all pixels that were observed.
    pub fn total_steps(&self, counter: StepCounter) -> u64 {
        let counts = self.values(|strip| &strip.step_counts);
        counts
            .map(|counts| u64::from(counts[counter as usize]))
            .sum()
    }

    /// Overwrites `counts` with a counter of the pixels of a strip.
    pub fn counter(&self, strip: &Strip, counter: Counter, counts: &mut Vec<u32>) {
        let uncounted = match counter {
            Counter::Samples => self.n_samples,
            _ => 0,
        };
        counts.clear();
        counts.resize(strip.rgb.len(), uncounted);
        self.add_counts(strip, counter, counts);
        self.clear_missing(strip, counts);
    }

    /// Returns the number of samples of each pixel, row-major, row 0 on top. The film has counters.
    pub(crate) fn samples(&self) -> Vec<u32> {
        let mut of_strip = Vec::new();
        let strips = self.strips.iter().flat_map(|strip| {
            self.counter(strip, Counter::Samples, &mut of_strip);
            of_strip.clone()
        });
        strips.collect()
    }

    /// Returns the number of pixels whose noise fell below the limit of adaptive sampling before
    /// their last sample; 0 unless samples are counted.
    pub fn n_below_noise(&self) -> u64 {
        if !self.counts_samples() {
            return 0;
        }
        let wanted = 1..self.most_samples;
        let mut samples = Vec::new();
        let strips = self.strips.iter().map(|strip| {
            self.counter(strip, Counter::Samples, &mut samples);
            samples.iter().filter(|&n| wanted.contains(n)).count() as u64
        });
        strips.sum()
    }

    /// Overwrites `values` with a metric of the pixels of a strip; counts above 2^24 are rounded.
    pub fn costs(&self, strip: &Strip, metric: Metric, values: &mut Vec<f32>) {
        values.clear();
        match metric.source {
            MetricSource::Clock => return values.extend_from_slice(&strip.time_ns),
            MetricSource::Noise => return values.extend_from_slice(&strip.noise),
            MetricSource::Efficiency => return self.efficiency(strip, values),
            MetricSource::Lanes => {
                values.extend_from_slice(&strip.idle_lanes);
                return values.resize(strip.rgb.len(), f32::NAN);
            }
            MetricSource::DeviceClock => {
                values.extend_from_slice(&strip.cycles);
                return values.resize(strip.rgb.len(), f32::NAN);
            }
            _ => {}
        }
        let Some(parts) = metric.parts() else {
            let mut counts = Vec::new();
            self.counts(strip, metric, &mut counts);
            return values.extend(counts.iter().map(|&count| count as f32));
        };
        let [above, below] = parts.map(|part| {
            let mut values = Vec::new();
            self.costs(strip, part, &mut values);
            values
        });
        let ratio = |(&above, &below): (&f32, &f32)| if below > 0.0 { above / below } else { 0.0 };
        values.extend(above.iter().zip(&below).map(ratio));
    }

    /// Appends one over the variance and the cost of a sample, for the pixels of a strip; NaN where
    /// all samples are equal.
    fn efficiency(&self, strip: &Strip, values: &mut Vec<f32>) {
        // Variance of the mean times cost of all samples: both have the number of samples as a
        // factor, once as divisor.
        let chosen = self.extra.noise.and_then(|noise| noise.cost);
        let costs = chosen.map_or(
            vec![Metric::NODE_VISITS, Metric::PRIMITIVE_TESTS],
            |array| Metric::named(array.name()).into_iter().collect(),
        );
        let mut sums = vec![0.0; strip.noise.len()];
        for cost in costs {
            self.costs(strip, cost, values);
            let costs = values.iter().map(|&cost| f64::from(cost));
            sums.iter_mut()
                .zip(costs)
                .for_each(|(sum, cost)| *sum += cost);
        }
        values.clear();
        // With 64 bits: the square of a low noise has no digits in 32.
        let efficiency = |(&noise, &cost): (&f32, &f64)| match f64::from(noise).powi(2) * cost {
            0.0 => f32::NAN,
            product => (1.0 / product) as f32,
        };
        values.extend(strip.noise.iter().zip(&sums).map(efficiency));
    }

    /// Returns a metric of all pixels, row-major, row 0 on top; counts above 2^24 are rounded.
    pub fn metric(&self, metric: Metric) -> Vec<f32> {
        let n_pixels = self.grid.width as usize * self.grid.height as usize;
        let (mut of_strip, mut all) = (Vec::new(), Vec::with_capacity(n_pixels));
        for strip in &self.strips {
            self.costs(strip, metric, &mut of_strip);
            all.append(&mut of_strip);
        }
        all
    }

    /// Returns the first two [metrics](Metric::with_own) that are not zero in the whole picture:
    /// without a hierarchy, for example, no node is visited. `None` for a film without cost.
    pub fn heatmap_metrics(&self) -> Option<[Metric; 2]> {
        if !self.cost.has_counters() {
            return None;
        }
        let metrics = Metric::with_own(self.extra.metrics);
        let mut shown = metrics.filter(|&metric| self.has_any(metric));
        Some([shown.next()?, shown.next()?])
    }

    /// Returns the metrics that are shown of the film's VTK files, two if they have two; metrics
    /// that are not zero come first, and idle lanes second.
    pub fn metrics_in_files(&self) -> [Option<Metric>; 2] {
        let is_in_files = |metric: &Metric| self.columns().any(|column| column.name == metric.name);
        let in_files = || Metric::with_own(self.extra.metrics).filter(is_in_files);
        let counted = in_files().filter(|&metric| self.has_any(metric));
        let zero = in_files().filter(|&metric| !self.has_any(metric));
        let mut metrics = counted.chain(zero);
        let first = metrics.next();
        let lanes = in_files().filter(|&metric| metric == Metric::IDLE_LANES);
        let second = lanes.chain(metrics).find(|&metric| Some(metric) != first);
        [first, second]
    }

    /// Returns true if a metric is not zero in the whole picture.
    fn has_any(&self, metric: Metric) -> bool {
        match metric.source {
            MetricSource::Clock => Metric::measured_by(self.cost) == Some(metric),
            MetricSource::Observed(counter) => self.total_steps(counter) > 0,
            MetricSource::Counter(_) | MetricSource::AllRays => metric.value(&self.totals) > 0,
            MetricSource::Noise | MetricSource::Efficiency => self.extra.noise.is_some(),
            MetricSource::Lanes => self.extra.lanes.is_some(),
            MetricSource::DeviceClock => self.extra.cycles,
            MetricSource::Ratio(_) => (metric.parts())
                .is_some_and(|parts| parts.into_iter().all(|part| self.has_any(part))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::TileGrid;
    use scene::config::CostMode;

    #[test]
    fn a_film_without_cost_has_no_metric_to_show() {
        for (mode, is_shown) in [(CostMode::None, false), (CostMode::Time, true)] {
            let mut film = Film::new(TileGrid::new(3, 2, 2), 4, mode);
            film.totals.rays[0] = 24;
            assert_eq!(film.heatmap_metrics().is_some(), is_shown);
        }
    }
}
