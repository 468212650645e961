"""Technical data of a machine as a submodel of its asset administration shell (IDTA 02003)."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from toothspace.core.errors import CaseError
from toothspace.core.files import write_text
from toothspace.results.solution import Solution
from toothspace.results.variables import label_of, stem_and_unit

_ARBITRARY = "https://admin-shell.io/SMT/General/Arbitrary"
_IEC_61360 = "https://admin-shell.io/DataSpecificationTemplates/DataSpecificationIec61360/3"
_AREA = "0173-1#02-ABL358#002/0173-1#01-AHX773#002"


def write_technical_data(solution: Solution, path: Path, manufacturer: str, article: str) -> Path:
    """Write a run as technical data of a product, in the JSON of asset administration shells.

    One shell of kind ``Type`` with the submodel ``TechnicalData``: what the template asks for of
    the manufacturer, and two sections of properties with units, dimensions of the machine and what
    the run found at its operating point. The order code is the article number.

    Parameters
    ----------
    solution : Solution
        Result of a run.
    path : Path
        File to write, by custom ``*.json``.
    manufacturer, article : str
        Name of the manufacturer and number of the article.

    Raises
    ------
    CaseError
        If one of the texts is empty.

    References
    ----------
    .. [1] Industrial Digital Twin Association, *IDTA 02003 Technical Data*, version 2.0.2,
       github.com/admin-shell-io/submodel-templates.
    """
    for option, text in (("--manufacturer", manufacturer), ("--article", article)):
        if not text.strip():
            raise CaseError(option, "nothing", "a text, which technical data must have")
    identity = solution.provenance.get("case_hash") or path.stem
    title = solution.provenance.get("title") or path.stem
    geometry = solution.description.geometry_summary if solution.description else {}
    sections = {"Machine": geometry, "OperatingPoint": solution.summary()}
    submodel = {
        "modelType": "Submodel",
        "id": f"urn:toothspace:submodel:{identity}",
        "idShort": "TechnicalData",
        "kind": "Instance",
        "administration": {
            "version": "2",
            "revision": "0",
            "templateId": "https://admin-shell.io/idta-02003-2-0",
        },
        "semanticId": {
            "type": "ModelReference",
            "keys": [{"type": "Submodel", "value": "0173-1#01-AHX837#002"}],
        },
        "submodelElements": [
            {
                "modelType": "SubmodelElementCollection",
                "idShort": "GeneralInformation",
                "semanticId": _meaning("0173-1#02-ABK161#002/0173-1#01-AHX838#002"),
                "value": [
                    _text("ManufacturerName", "0173-1#02-AAO677#004", manufacturer),
                    {
                        "modelType": "MultiLanguageProperty",
                        "idShort": "ManufacturerProductDesignation",
                        "semanticId": _meaning("0173-1#02-AAW338#003"),
                        "value": _english(title),
                    },
                    _text("ManufacturerArticleNumber", "0173-1#02-AAO676#005", article),
                    _text("ManufacturerOrderCode", "0173-1#02-AAO227#004", article),
                ],
            },
            {
                "modelType": "SubmodelElementList",
                "idShort": "TechnicalPropertyAreas",
                "semanticId": _meaning("0173-1#02-ABK163#002"),
                "semanticIdListElement": _meaning(_AREA),
                "typeValueListElement": "SubmodelElementCollection",
                "value": [
                    {
                        "modelType": "SubmodelElementCollection",
                        "semanticId": _meaning(_AREA),
                        "value": [_section(*entry) for entry in sections.items() if entry[1]],
                    }
                ],
            },
        ],
    }
    shell = {
        "modelType": "AssetAdministrationShell",
        "id": f"urn:toothspace:aas:{identity}",
        "assetInformation": {
            "assetKind": "Type",
            "globalAssetId": f"urn:toothspace:asset:{identity}",
        },
        "submodels": [
            {
                "type": "ModelReference",
                "keys": [{"type": "Submodel", "value": submodel["id"]}],
            }
        ],
    }
    content = {"assetAdministrationShells": [shell], "submodels": [submodel]}
    return write_text(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


def _meaning(value: str) -> dict[str, Any]:
    return {"type": "ExternalReference", "keys": [{"type": "GlobalReference", "value": value}]}


def _english(text: str) -> list[dict[str, str]]:
    return [{"language": "en", "text": text}]


def _text(name: str, meaning: str, value: str) -> dict[str, Any]:
    return {
        "modelType": "Property",
        "idShort": name,
        "semanticId": _meaning(meaning),
        "valueType": "xs:string",
        "value": value,
    }


def _section(name: str, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Section of the properties that are finite numbers or texts."""
    return {
        "modelType": "SubmodelElementCollection",
        "idShort": name,
        "semanticId": _meaning(_ARBITRARY),
        "value": [
            _property(key, value)
            for key, value in numbers.items()
            if (isinstance(value, (int, float)) and math.isfinite(value))
            or (isinstance(value, str) and value)
        ],
    }


def _property(name: str, value: Any) -> dict[str, Any]:
    found = _text(name, _ARBITRARY, str(value)) | {"displayName": _english(label_of(name))}
    if isinstance(value, bool):
        return found | {"valueType": "xs:boolean", "value": str(value).lower()}
    if isinstance(value, str):
        return found
    content: dict[str, Any] = {
        "modelType": "DataSpecificationIec61360",
        "preferredName": _english(stem_and_unit(name)[0].replace("_", " ")),
        "dataType": "REAL_MEASURE",
        "unit": stem_and_unit(name)[1],
    }
    specification = {"dataSpecification": _meaning(_IEC_61360), "dataSpecificationContent": content}
    return found | {
        "valueType": "xs:double",
        "value": repr(float(value)),
        "embeddedDataSpecifications": [specification],
    }
