"""The live viewer in a browser, and the one door to viser."""

from mmplan.visualization.viewer.viewer import Viewer

__all__ = ["Viewer"]
