"""How wrong a solution can be: evidence, and a verdict."""

from .certify import Certificate, certify
from .energy import EnclosureEnergy

__all__ = ["Certificate", "EnclosureEnergy", "certify"]
