"""The light of each order by random walks: the yardstick that needs no form factors."""

from .tracer import PathTracer, WalkedLight

__all__ = ["PathTracer", "WalkedLight"]
