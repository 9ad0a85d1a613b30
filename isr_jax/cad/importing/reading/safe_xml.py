"""Border: XML of foreign files, without entities, without references to other files."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import defusedxml
import defusedxml.ElementTree

from ....errors import LibraryError
from ..names import shown
from .limits import ReadLimits


def parse_xml(content: bytes, name: str, limits: ReadLimits) -> ET.Element:
    """The root element; raises `LibraryError` for bad XML, a document type, or a deep tree."""
    try:
        root = defusedxml.ElementTree.fromstring(content, forbid_dtd=True)
    except defusedxml.DefusedXmlException as error:
        problem = f"{shown(name)} declares a document type or entities ({type(error).__name__})"
        raise LibraryError(problem, "write it without <!DOCTYPE ...>") from None
    except (ET.ParseError, ValueError, LookupError) as error:
        raise LibraryError(f"{shown(name)} is no valid XML: {error}", "restore the file") from None
    layer, depth = [root], 0
    while layer:
        depth += 1
        if depth > limits.max_xml_depth:
            problem = f"{shown(name)} nests elements more than {limits.max_xml_depth} deep"
            raise LibraryError(problem, "write it flatter")
        layer = [child for element in layer for child in element]
    return root
