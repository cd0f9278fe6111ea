"""Shows the pipe bend ELBOW with its temperature in the window of ParaView."""

import os

from paraview import simple as pv

view = pv.GetActiveViewOrCreate("RenderView")
elbow = pv.OpenDataFile(os.environ["ELBOW"])
elbow.UpdatePipeline()
shown = pv.Show(elbow, view)
pv.ColorBy(shown, ("POINTS", "temperature"))
colors = pv.GetColorTransferFunction("temperature")
colors.ApplyPreset("Inferno (matplotlib)", True)
# Of the outer side: the hot water is inside.
colors.RescaleTransferFunction(290, 307)
shown.SetScalarBarVisibility(view, True)
pv.ResetCamera(view)
camera = pv.GetActiveCamera()
camera.Azimuth(30)
camera.Elevation(25)
pv.Render(view)
