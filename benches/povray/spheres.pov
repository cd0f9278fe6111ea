// The same scene as spheres.yaml.
#version 3.7;

global_settings { assumed_gamma 1 max_trace_level 5 }

// Off-axis: the window spans x from -1 to 1 and y from -0.5 to 1 at z = 0.
camera {
  location <0, 0.35, -1>
  direction <0, -0.1, 1>
  right <2, 0, 0>
  up <0, 1.5, 0>
}

light_source { <5, 5, -10> rgb 1 }

#declare Mirror = finish { ambient 0.05 diffuse 1 specular 1 roughness 1/50 reflection 0.5 }

sphere { <0.75, 0.1, 1>, 0.6 pigment { rgb <0, 0, 1> } finish { Mirror } }
sphere { <-0.75, 0.1, 2.25>, 0.6 pigment { rgb <0.5, 0.223, 0.5> } finish { Mirror } }
sphere { <-2.75, 0.1, 3.5>, 0.6 pigment { rgb <1, 0.572, 0.184> } finish { Mirror } }

plane {
  y, -0.5
  // The checker is solid: shifted up by a quarter, so that the plane is not between two cells.
  pigment { checker rgb 1, rgb 0 scale 0.5 translate 0.25 * y }
  finish { ambient 0.05 diffuse 0.75 specular 0.5 roughness 1/50 reflection 0.25 }
}
