"""The catalogue of rotations, the turns they are made of, and the checks of a model."""

from __future__ import annotations

import dataclasses

import pytest
import sympy as sp

from helpers.samples import ONE, chain, model, phi
from helpers.witness import CONVENTIONS
from rigidsym.errors import ModelError
from rigidsym.models.parametrisations import (
    EULER_SEQUENCES,
    EulerAngles,
    axis_turn,
    chain as chain_of,
)
from rigidsym.models.rotation import Turn


class TestCatalogue:
    def test_names_are_their_own(self):
        assert set(EULER_SEQUENCES) == set(CONVENTIONS)
        names = {EulerAngles(c, passive=p).name for c in CONVENTIONS for p in (False, True)}
        assert len(names) == 48
        assert {"euler_zxz_intrinsic", "euler_zyx_extrinsic"} <= names

    @pytest.mark.parametrize(
        ("sequence", "part"),
        [
            ("ZZX", "consecutive axes must differ"),
            ("133", "consecutive axes must differ: 3 follows 3; did you mean"),
            ("ZxZ", "do not mix"),
            ("ZX", "expected three axes"),
            ("414", "expected three axes"),
            ("", "expected three axes"),
        ],
    )
    def test_what_is_no_sequence_is_refused(self, sequence, part):
        with pytest.raises(ModelError, match="is not an Euler sequence") as caught:
            EulerAngles(sequence)
        assert part in str(caught.value)


class TestChecks:
    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"name": "Upper"}, "'Upper' cannot name a model"),
            ({"matrix": sp.ImmutableMatrix(sp.eye(2))}, "a rotation matrix is 3x3, got (2, 2)"),
            ({"coordinates": ()}, "needs at least one coordinate"),
            ({"coordinates": (phi, phi)}, "phi(t) is named twice"),
            ({"coordinates": (sp.Symbol("phi"),)}, "phi is not a function of t"),
            ({"units": ("rad", "m")}, "1 coordinates, but 2 units"),
            ({"turns": (Turn(axis="x", angle=phi),)}, "not the product of its turns, Rx(φ)"),
            (
                {"matrix": sp.ImmutableMatrix(sp.GoldenRatio * ONE)},
                "the number GoldenRatio, which is not",
            ),
        ],
        ids=str,
    )
    def test_a_constructed_model_is_valid(self, change, message):
        with pytest.raises(ModelError) as caught:
            dataclasses.replace(model(chain(("z", phi)), phi), **change)
        assert message in str(caught.value)

    def test_roots_of_roots_are_a_unit_axis_where_they_are_one(self):
        root = sp.sqrt(2 + sp.sqrt(2)) / 2  # cos π/8
        other = sp.sqrt(2 - sp.sqrt(2)) / 2
        nested = sp.sqrt(5 + 2 * sp.sqrt(6)) - sp.sqrt(2) - sp.sqrt(3)  # zero, not when expanded
        turns = [axis_turn((root, other, nested), phi)]
        assert chain_of(turns).constraints == ()
        near = axis_turn((root, other + sp.Rational(1, 10**40), 0), phi)
        assert near.components != (root, other + sp.Rational(1, 10**40), 0)  # made one
        assert axis_turn((1, 1, 0), phi).components == (sp.sqrt(2) / 2, sp.sqrt(2) / 2, 0)
