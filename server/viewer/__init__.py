"""The 3D view: viser servers behind a proxy, one for each viewing session."""

from server.viewer.routes import router
from server.viewer.session import ViewerLimits
from server.viewer.source import FrameSource, StoppedRun
from server.viewer.stills import Still, StillOptions, draw_still, read_still

__all__ = [
    "FrameSource",
    "Still",
    "StillOptions",
    "StoppedRun",
    "ViewerLimits",
    "draw_still",
    "read_still",
    "router",
]
