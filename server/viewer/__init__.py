"""The 3D view: viser servers behind a proxy, one for each viewing session."""

from server.viewer.routes import router
from server.viewer.session import ViewerLimits
from server.viewer.source import FrameSource

__all__ = ["FrameSource", "ViewerLimits", "router"]
