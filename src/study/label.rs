//! Where names stand beside marks: not over each other, nor over other marks.

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rect {
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
}

impl Rect {
    /// The square around a point.
    pub(super) fn around((x, y): (i32, i32), radius: i32) -> Self {
        Self {
            left: x - radius,
            top: y - radius,
            right: x + radius,
            bottom: y + radius,
        }
    }

    /// Pixels that both have.
    fn overlap(self, other: Self) -> i64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        i64::from(width.max(0)) * i64::from(height.max(0))
    }

    fn is_within(self, other: Self) -> bool {
        let is_beside = self.left >= other.left && self.right <= other.right;
        is_beside && self.top >= other.top && self.bottom <= other.bottom
    }
}

/// What of a plot is taken.
pub(super) struct Room {
    bounds: Rect,
    taken: Vec<Rect>,
}

impl Room {
    /// All within `bounds` is free.
    pub(super) fn new(bounds: Rect) -> Self {
        let taken = Vec::new();
        Self { bounds, taken }
    }

    /// Nothing is to cover this.
    pub(super) fn take(&mut self, rect: Rect) {
        self.taken.push(rect);
    }

    /// Takes the best place for a name of this width and height beside a mark,
    /// the one that covers least; on its right if that is as good.
    pub(super) fn place(&mut self, (x, y): (i32, i32), (width, height): (i32, i32)) -> Rect {
        let (near, far, farthest) = (9, 16, 27);
        let lefts = [x + near, x - near - width, x - width / 2];
        let tops = [
            y + 2,
            y - 2 - height,
            y - height / 2,
            y + near,
            y - near - height,
            y + far,
            y - far - height,
            y + farthest,
            y - farthest - height,
        ];
        let at = |left: i32, top: i32| Rect {
            left,
            top,
            right: left + width,
            bottom: top + height,
        };
        let places = tops.iter().flat_map(|&top| lefts.map(|left| at(left, top)));
        let cost = |place: &Rect| {
            let covered = self
                .taken
                .iter()
                .map(|rect| rect.overlap(*place))
                .sum::<i64>();
            (!place.is_within(self.bounds), covered)
        };
        let best = places.min_by_key(cost).unwrap_or_else(|| at(x, y));
        self.taken.push(best);
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_a_crowd_do_not_cover_each_other() {
        let bounds = Rect::around((100, 100), 100);
        let mut room = Room::new(bounds);
        let marks = [(100, 100), (108, 104), (112, 98), (190, 100)];
        for mark in marks {
            room.take(Rect::around(mark, 6));
        }
        let names = marks.map(|mark| room.place(mark, (40, 14)));
        for (i, name) in names.iter().enumerate() {
            assert!(name.is_within(bounds), "{name:?}");
            assert!(names[..i].iter().all(|other| name.overlap(*other) == 0));
            let covered = marks.map(|mark| name.overlap(Rect::around(mark, 6)));
            assert_eq!(covered, [0; 4], "{name:?}");
        }
    }

    #[test]
    fn a_name_alone_stands_on_the_right() {
        let mut room = Room::new(Rect::around((100, 100), 100));
        let name = room.place((50, 50), (40, 14));
        assert_eq!((name.left, name.top), (59, 52));
    }
}
