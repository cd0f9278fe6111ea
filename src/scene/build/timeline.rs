//! The frames of a scene, their times, and the files of data series that they show.

use super::arrays;
use super::geometries::{Extra, read_checked};
use crate::animation::Animation;
use crate::config::{Config, Geometry, GeometryFile, at_value};
use crate::yaml::{Fault, FieldPath, Folders};
use base::stop;
use import::DataSeries;

/// The frames of a scene that changes over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// The changes of its values.
    pub animation: Animation,
    /// The number of frames, at least 1.
    pub n_frames: u32,
    /// The data series by the index of their object.
    series: Vec<(usize, DataSeries)>,
    /// The range of the colors over all time steps, by the index of the material.
    ranges: Vec<(usize, [f64; 2])>,
}

/// A frame of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneFrame {
    /// Number, from 0.
    pub number: u32,
    /// The number of all frames.
    pub n_frames: u32,
    /// Time, as in the first data series or, without one, in seconds of the video.
    pub time: f64,
}

impl Timeline {
    /// Returns the timeline of a config; `None` for a still.
    ///
    /// # Errors
    /// The first mistake in the section `animation`, or in a data series.
    pub fn parse<F: Folders + ?Sized>(config: &Config, folders: &F) -> Result<Option<Self>, Fault> {
        let mut series = Vec::new();
        for (index, object) in config.objects.iter().enumerate() {
            let Geometry::File(file) = &object.geometry else {
                continue;
            };
            let path = file_path(index, file);
            let found = import::time_steps(folders.folder_of(&path), file.data_file());
            let found = found.map_err(at_value(&path))?;
            series.extend(found.map(|found| (index, found)));
        }
        if config.animation.is_none() && series.is_empty() {
            return Ok(None);
        }
        let animation = config.animation.clone().unwrap_or_default();
        let longest = series.iter().map(|(_, series)| series.0.len() as u32).max();
        let n_frames = animation.frames.or(longest);
        let n_frames = n_frames.ok_or_else(|| animation.without_frames())?;
        animation.check(n_frames)?;
        Ok(Some(Self {
            animation,
            n_frames,
            series,
            ranges: Vec::new(),
        }))
    }

    /// Finds the range of the colors over all time steps, for the materials whose range comes from
    /// the data: reads all files of their series, one after the other, with at most `available`
    /// bytes of memory each.
    ///
    /// # Errors
    /// A file cannot be read, or lacks the array.
    pub fn find_ranges<F: Folders + ?Sized>(
        &mut self,
        config: &Config,
        folders: &F,
        available: u64,
    ) -> Result<(), Fault> {
        for (number, (name, material)) in config.materials.iter().enumerate() {
            let Some(texture) = material
                .color
                .array()
                .filter(|texture| texture.is_of_data())
            else {
                continue;
            };
            let has_it = |index: usize| config.objects[index].material.0.contains(name);
            if !self.series.iter().any(|(index, _)| has_it(*index)) {
                continue;
            }
            let mut ends = Vec::new();
            for index in (0..config.objects.len()).filter(|&index| has_it(index)) {
                for file in self.files_of(config, index) {
                    if stop::check().is_err() {
                        return Ok(());
                    }
                    let path = file_path(index, &file);
                    let folder = folders.folder_of(&path);
                    let array = Extra::Array(arrays::choice(config, &config.objects[index])?);
                    let read = read_checked(&file, folder, array, available, &path)?;
                    ends.extend(
                        read.numbers_for(texture)
                            .and_then(|numbers| texture.shown_ends(&numbers)),
                    );
                }
            }
            self.ranges.push((number, texture.clone().span(&ends)));
        }
        Ok(())
    }

    /// Returns the files of an object, one per step of a series.
    fn files_of(&self, config: &Config, index: usize) -> Vec<GeometryFile> {
        let Geometry::File(file) = &config.objects[index].geometry else {
            return Vec::new();
        };
        match self.series.iter().find(|(known, _)| *known == index) {
            None => vec![file.clone()],
            Some((_, series)) => {
                let steps = series.0.iter();
                steps.map(|step| file.at(step)).collect()
            }
        }
    }

    /// Returns a frame, whose number is less than [`n_frames`](Self::n_frames).
    pub fn frame(&self, number: u32) -> SceneFrame {
        let time = match self.series.first() {
            None => f64::from(number) / f64::from(self.animation.fps),
            Some((_, series)) => self.time_in(series, number),
        };
        SceneFrame {
            number,
            n_frames: self.n_frames,
            time,
        }
    }

    /// Returns the time of a frame in a series, interpolated between two steps.
    fn time_in(&self, DataSeries(steps): &DataSeries, number: u32) -> f64 {
        let (step, part) = self.step_of(steps.len(), number);
        let time = steps[step].time;
        let span = match steps.get(step + 1) {
            Some(next) => next.time - time,
            None => step
                .checked_sub(1)
                .map_or(1.0, |before| time - steps[before].time),
        };
        time + span * part
    }

    /// Returns the time step of a series of `n_steps` that a frame shows, and the elapsed fraction
    /// of that step: all steps have the same number of frames, as far as possible.
    fn step_of(&self, n_steps: usize, number: u32) -> (usize, f64) {
        let (n_steps, n_frames) = (n_steps as u64, u64::from(self.n_frames));
        let at = u64::from(number) * n_steps;
        let part = (at % n_frames) as f64 / n_frames as f64;
        ((at / n_frames) as usize, part)
    }

    /// Turns the config into a still of a frame, with the files of its time step and the color
    /// ranges over all steps.
    pub fn make_still(&self, config: &mut Config, number: u32) {
        config.animation = None;
        for (index, DataSeries(steps)) in &self.series {
            let step = &steps[self.step_of(steps.len(), number).0];
            if let Some(object) = config.objects.get_mut(*index)
                && let Geometry::File(series) = &object.geometry
            {
                object.geometry = Geometry::File(series.at(step));
            }
        }
        for (number, range) in &self.ranges {
            let material = config.materials.get_index_mut(*number);
            if let Some(texture) = material.and_then(|(_, material)| material.color.array_mut()) {
                texture.span(&[*range]);
            }
        }
    }
}

/// Returns the path of the value that names the file of an object.
fn file_path(index: usize, file: &GeometryFile) -> FieldPath {
    let object = FieldPath::default().key("objects").index(index);
    object.key(file.to_string()).key("file")
}

#[cfg(test)]
mod tests {
    use super::*;
    use import::TimeStep;

    fn timeline(n_frames: u32, times: &[f64]) -> Timeline {
        let step = |&time: &f64| TimeStep {
            file: format!("{time}.vtu").into(),
            step: None,
            time,
        };
        Timeline {
            animation: Animation::default(),
            n_frames,
            series: vec![(0, DataSeries(times.iter().map(step).collect()))],
            ranges: Vec::new(),
        }
    }

    #[test]
    fn as_many_frames_as_steps_have_their_times() {
        let times = [0.5, 0.75, 2.0];
        let timeline = timeline(3, &times);
        for (number, time) in times.into_iter().enumerate() {
            assert_eq!(timeline.frame(number as u32).time, time);
            assert_eq!(timeline.step_of(3, number as u32), (number, 0.0));
        }
    }

    #[test]
    fn more_frames_than_steps_ascend_and_fewer_leave_steps_out() {
        let times = [0.5, 0.75, 2.0];
        for n_frames in 1..20 {
            let timeline = timeline(n_frames, &times);
            let frames: Vec<f64> = (0..n_frames).map(|n| timeline.frame(n).time).collect();
            assert!(frames.is_sorted_by(|a, b| a < b), "{frames:?}");
            assert_eq!(frames[0], times[0]);
            let last = timeline.step_of(3, n_frames - 1).0;
            assert_eq!(last, (3 * (n_frames as usize - 1)) / n_frames as usize);
        }
    }
}
