"""Shows a ball with colors in the window of ParaView."""

from paraview import simple as pv

view = pv.GetActiveViewOrCreate("RenderView")
ball = pv.Show(pv.Sphere(ThetaResolution=40, PhiResolution=40), view)
pv.ColorBy(ball, ("POINTS", "Normals", "Z"))
pv.ResetCamera(view)
pv.Render(view)
