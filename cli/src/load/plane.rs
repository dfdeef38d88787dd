//! The plane in which a mesh with third coordinates lies.

use crate::error::CliError;
use crate::load::frame::{Farthest, Frame, Point};
use crate::terminal::numbers::sig6;
use mesh_io::{MeshFile, PointField};

/// The plane of a mesh with third coordinates, in which the mesh is smoothed.
pub(crate) struct Plane {
    frame: Frame,
    /// The vertices of the file, in space.
    space: Vec<Point>,
    /// The vertices of the file, in the plane.
    flat: Vec<[f64; 2]>,
}

impl Plane {
    /// Returns the plane of a mesh; `None` if the mesh has no third coordinates, or equal ones.
    ///
    /// # Errors
    /// Returns an error if the vertices do not lie in one plane, or if some vertices lack z.
    pub(crate) fn of(file: &MeshFile) -> Result<Option<Self>, CliError> {
        let Some((space, is_replaceable)) = in_space(file)? else { return Ok(None) };
        let path = file.path().display();
        let frame = Frame::of(&space, file.precision()).map_err(|Farthest { vertex, distance }| {
            let place = file.vertex_location(vertex as u32);
            CliError::input(format!(
                "{place}: the mesh is not planar: vertex {} is at a distance of {} from the plane nearest to all vertices",
                place.id,
                sig6(distance)
            ))
            .with_remedy(
                "If z is data of a mesh in x and y, such as the depth of water, add --z data. Curved surfaces are not smoothed",
            )
        })?;
        if frame != Frame::Axes([0, 1]) && !is_replaceable {
            return Err(CliError::input(format!("{path}: some vertices have no z"))
                .with_remedy("Give each vertex three coordinates, or add --z data if z is data"));
        }
        let flat = frame.flat(&space);
        Ok(Some(Self { frame, space, flat }))
    }

    /// Returns the plane of `file`, another state of the mesh of this plane, in the coordinates of this plane.
    pub(crate) fn likewise(&self, file: &MeshFile) -> Result<Self, CliError> {
        let flat_z = || file.points().iter().map(|&[x, y]| [x, y, 0.0]).collect();
        let space = in_space(file)?.map_or_else(flat_z, |(space, _)| space);
        let flat = self.frame.flat(&space);
        Ok(Self { frame: self.frame, space, flat })
    }

    /// Returns the vertices of the file, in the plane.
    pub(crate) fn points(&self) -> &[[f64; 2]] {
        &self.flat
    }

    /// Returns whether the plane is that of x and y.
    pub(crate) fn is_of_xy(&self) -> bool {
        self.frame == Frame::Axes([0, 1])
    }

    /// Returns whether the plane is tilted: coordinates in the plane are then no coordinates of the file.
    pub(crate) fn is_tilted(&self) -> bool {
        matches!(self.frame, Frame::Tilted { .. })
    }

    /// Returns x, y and z of vertices at `points` of the plane.
    pub(crate) fn in_space(&self, points: &[[f64; 2]]) -> Vec<Point> {
        let from = self.space.iter().zip(&self.flat);
        from.zip(points).map(|((&at, &from), &to)| self.frame.moved(at, from, to)).collect()
    }

    /// Returns the positions in the plane that a file of this mesh gives to vertices at `points` of the plane, after
    /// its numbers were rounded.
    pub(crate) fn as_stored(
        &self,
        points: &[[f64; 2]],
        stored: mesh_io::Precision,
    ) -> Vec<[f64; 2]> {
        let mut space = self.in_space(points);
        space.as_flattened_mut().iter_mut().for_each(|x| *x = stored.rounded(*x));
        self.frame.flat(&space)
    }

    /// Returns the third coordinates of vertices at `points` of the plane, as a field for a rewrite of the file. `None`
    /// in the plane of x and y, where z stays as it is.
    pub(crate) fn z_field(
        &self,
        file: &MeshFile,
        points: &[[f64; 2]],
    ) -> Result<Option<PointField>, CliError> {
        if self.is_of_xy() {
            return Ok(None);
        }
        let mut fields = file.point_fields(Some(&["z".to_owned()]))?;
        if fields.is_empty() {
            return Ok(None);
        }
        let mut z = fields.swap_remove(0);
        z.set(self.in_space(points).iter().map(|point| point[2]).collect())?;
        Ok(Some(z))
    }

    /// Lists the vertices that have left this plane in `after`, ascending.
    pub(crate) fn strays(&self, after: &Self, stored: mesh_io::Precision) -> Vec<u32> {
        self.frame.strays(&self.space, &after.space, stored)
    }

    /// Returns the names of the two coordinates in the plane: two of x, y and z, or u and v in a tilted plane.
    pub(crate) fn axes(&self) -> [&'static str; 2] {
        match self.frame {
            Frame::Axes(axes) => axes.map(|axis| ["x", "y", "z"][axis]),
            Frame::Tilted { .. } => ["u", "v"],
        }
    }

    /// Names the axes of a view of the mesh; `None` for the plane of x and y.
    pub(crate) fn legend(&self) -> Option<String> {
        let [across, up] = self.axes();
        let plane = if self.is_tilted() { " in a tilted plane" } else { "" };
        (!self.is_of_xy()).then(|| format!("{across} to the right, {up} upward{plane}"))
    }

    /// Describes the plane for the user; `None` for the plane of x and y.
    pub(crate) fn remark(&self) -> Option<String> {
        match self.frame {
            Frame::Axes([0, 1]) => None,
            Frame::Axes(_) => {
                let [a, b] = self.axes();
                Some(format!(
                    "the mesh lies in the plane of {a} and {b}, and is smoothed in it: positions in options, pictures and reports are {a} and {b}"
                ))
            }
            Frame::Tilted { .. } => {
                let [x, y, z] = self.frame.normal().map(sig6);
                Some(format!(
                    "the mesh lies in a tilted plane with the normal ({x}, {y}, {z}), and is smoothed in it: positions in options, pictures and reports are lengths u and v in this plane, from the mean of all vertices"
                ))
            }
        }
    }
}

/// Returns the vertices of a file in space, and whether a rewrite can replace each z. `None` if the mesh has no third
/// coordinates, or equal ones.
fn in_space(file: &MeshFile) -> Result<Option<(Vec<Point>, bool)>, CliError> {
    if !file.has_third_coordinates() {
        return Ok(None);
    }
    let fields = file.point_fields(Some(&["z".to_owned()]))?;
    Ok(fields.first().map(|z| {
        let pairs = file.points().iter().zip(z.values());
        (pairs.map(|(&[x, y], &z)| [x, y, z]).collect(), z.is_replaceable())
    }))
}
