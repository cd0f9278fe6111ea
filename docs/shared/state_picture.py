"""Saves the views of a state as a picture: pvbatch state_picture.py STATE FILE WIDTH HEIGHT"""

import sys

from paraview import simple as pv

state, file, width, height = sys.argv[1:]
pv._DisableFirstRenderCameraReset()
pv.LoadState(state)
pv.SaveScreenshot(file, pv.GetLayout(), ImageResolution=[int(width), int(height)])
