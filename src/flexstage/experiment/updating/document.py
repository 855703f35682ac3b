"""Body of the document of an update."""

from __future__ import annotations

from flexstage.base.document import Document
from flexstage.experiment.document import compare_body
from flexstage.experiment.updating.update import Residual, Updated


def update_body(found: Updated) -> Document:
    """Numbers before and after with their deviations, correlations, combinations, residuals, and theory beside the test afterwards."""
    known = found.known
    return {
        "parameters": [parameter_body(found, index) for index in range(len(found.parameters))],
        "correlations": found.correlations.to_json(),
        "combinations": [
            {
                "singular_value": float(size),
                "prior_variance_left": float(1.0 / (1.0 + size**2)),
                "direction": dict(zip(found.parameters, column.tolist(), strict=True)),
            }
            for size, column in zip(found.singular, found.directions.T, strict=True)
        ],
        "assumed": {"prior": known.prior, "priors": dict(known.priors), "model_error": known.model_error, "gain_error": known.gain_error},
        "residuals": [residual_body(each) for each in found.residuals],
        "chi_square": {
            "before": found.chi_square_before,
            "after": found.chi_square,
            "data": found.freedoms,
            "probability": found.probability,
        },
        "steps": found.steps,
        "compared": compare_body(found.compared),
        "warnings": list(found.warnings),
        "provenance": found.provenance,
    }


def parameter_body(found: Updated, index: int) -> Document:
    """One number before and after; deviations are relative."""
    return {
        "address": found.parameters[index],
        "unit": found.units[index],
        "before": float(found.before[index]),
        "after": float(found.after[index]),
        "change": float(found.changes[index]),
        "prior_deviation": float(found.prior[index]),
        "deviation": float(found.deviations[index]),
        "interval": found.intervals[index].tolist(),
        "prior_variance_left": float(found.left[index]),
        "told": found.told[index].value,
        "verdict": found.verdicts[index],
    }


def residual_body(residual: Residual) -> Document:
    """One datum by test and theory; misfits are in standard deviations.

    >>> residual_body(Residual("mode 1 (z)", "Hz", 101.0, 0.01, 100.0, 101.0, 101.0))["misfit_after"]
    0.0
    """
    return {
        "name": residual.name,
        "unit": residual.unit,
        "measured": residual.measured,
        "deviation": residual.deviation,
        "before": residual.before,
        "after": residual.after,
        "misfit_before": residual.misfit_before,
        "misfit_after": residual.misfit,
    }
