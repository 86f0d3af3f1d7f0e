"""How wrong a solution can be: evidence, and a verdict."""

from .energy import EnclosureEnergy
from .verdict import Certificate, certify

__all__ = ["Certificate", "EnclosureEnergy", "certify"]
