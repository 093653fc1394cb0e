"""What the buttons of a page copy runs, and agrees with the kernels."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from helpers.pages import copied, motion_of, page_of


def test_what_is_copied_as_python_runs_and_agrees_with_the_kernels():
    for rotation in ("ZXZ", "rotation_vector", "davenport"):
        motion = motion_of(rotation)
        known = motion.kernels().load()
        rng = np.random.default_rng(4)
        for name, text in copied(page_of(rotation), "python").items():
            inputs = motion.step(name).quantity.inputs
            vectors = [rng.uniform(-2, 2, len(motion.argument(i).symbols)) for i in inputs]
            scope: dict[str, object] = {}
            exec(text, scope)  # what a reader would do with it
            found = np.array(scope[name](*vectors))
            expected = getattr(known, name)(*vectors)
            np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
def test_what_is_copied_as_c_compiles_without_a_warning_and_agrees(tmp_path: Path):
    strict = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC")
    for rotation in ("ZXZ", "rotation_vector", "davenport"):
        motion = motion_of(rotation)
        known = motion.kernels().load()
        rng = np.random.default_rng(4)
        for name, text in copied(page_of(rotation), "c").items():
            source, made = tmp_path / f"{rotation}_{name}.c", tmp_path / f"{rotation}_{name}.so"
            source.write_text(text, encoding="utf-8")
            subprocess.run(["cc", *strict, source, "-o", made, "-lm"], check=True)
            inputs = motion.step(name).quantity.inputs
            vectors = [rng.uniform(-2, 2, len(motion.argument(i).symbols)) for i in inputs]
            expected = getattr(known, name)(*vectors)
            out = np.empty(expected.size)
            pointers = [ctypes.c_void_p(array.ctypes.data) for array in (*vectors, out)]
            getattr(ctypes.CDLL(str(made)), name)(*pointers)
            np.testing.assert_allclose(out, expected.ravel(), rtol=1e-12, atol=1e-13)


def test_what_is_copied_as_latex_is_the_equation():
    copies = copied(page_of("ZXZ"), "latex")
    assert list(copies) == [step.quantity.name for step in motion_of("ZXZ").steps]
    assert copies["angular_velocity_body"].startswith("\\[\n\\boldsymbol{\\Omega}'")
