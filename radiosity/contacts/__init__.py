"""Faces that touch or lie in each other are cut, so that no patch lies half under something."""

from .remove import remove_contacts as remove_contacts
from .report import Contact as Contact
from .report import ContactReport as ContactReport
from .rules import Kind as Kind
