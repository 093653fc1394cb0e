"""`rigidsym identify` as a user meets it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from helpers.command import call
from helpers.conventions import GENERIC, attitude, sample
from rigidsym.tools.identify.readings import VELOCITIES, Reading

AEROSPACE = Reading(sequence="ZYX", columns=(2, 1, 0), passive=True, degrees=True)


def listed(numbers) -> str:
    return ",".join(repr(float(number)) for number in np.ravel(numbers))


def options(given) -> list[str]:
    return [word for name, part in given.items() for word in (f"--{name}", listed(part))]


def test_one_sample_is_named_first_and_its_calls_follow(tmp_path):
    matrix = listed(attitude(AEROSPACE, (10, 20, 30))["matrix"])
    angles = "roll=10, pitch=20, yaw=30"
    done = call("identify", "--angles", angles, "--matrix", matrix, cwd=tmp_path)
    lines = done.stdout.splitlines()
    assert lines[:4] == [
        "xyz extrinsic, passive, degrees, columns (roll, pitch, yaw)",
        "= ZYX intrinsic, passive, columns (yaw, pitch, roll)",
        "",
        "matrix = (Rz(yaw) Ry(pitch) Rx(roll))ᵀ",
    ]
    assert 'Rotation.from_euler("xyz", angles, degrees=True).inv()' in done.stdout
    assert max(map(len, lines)) <= 80
    assert done.stderr == ""
    assert list(tmp_path.iterdir()) == []


def test_several_samples_with_signs_and_velocity_as_json(tmp_path):
    reading = Reading(sequence="ZXZ", scalar_last=True, velocity=VELOCITIES[1])
    words = [
        word
        for angles in (GENERIC[False], (-0.2, 0.5, 0.6))
        for word in options(sample(reading, angles))
    ]
    data = json.loads(call("identify", *words, "--json", cwd=tmp_path).stdout)
    assert (data["schema"], data["fits"], data["samples"]) == ("rigidsym.identification", True, 2)
    (answer,) = data["answers"]
    assert answer["reading"]["words"].startswith("ZXZ intrinsic, active, radians")
    assert answer["reading"]["velocity"] == {"frame": "body", "opposite": False, "units": ""}
    assert set(answer["calls"]) == {"SciPy", "rigidsym"}
    assert len(answer["aliases"]) == 3
    assert data["nearest"] is None
    assert data["further"] is None


def test_several_answers_are_cut_short_and_say_what_would_separate_them(tmp_path):
    words = options(sample(Reading(sequence="ZYX", degrees=True), (0, 0, 40)))
    done = call("identify", *words, cwd=tmp_path)
    assert "96 conventions fit 1 sample, all degrees" in done.stdout
    assert "and 90 more; --all shows them" in done.stdout
    assert "To tell them apart, add a sample with these values in the columns:\n" in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80
    everything = call("identify", *words, "--all", cwd=tmp_path).stdout
    assert everything.count("from scipy.spatial.transform") == 96
    data = json.loads(call("identify", *words, "--json", cwd=tmp_path).stdout)
    assert len(data["answers"]) == 96
    assert data["further"] == {"angles": [15.0, 20.0, 50.0], "rates": None}


def test_no_fit_is_an_answer_with_exit_code_1(tmp_path):
    matrix = listed(attitude(AEROSPACE, (10, 20, 30.5))["matrix"])
    words = ("identify", "--angles", "10,20,30", "--matrix", matrix)
    done = call(*words, cwd=tmp_path, status=1)
    assert "No convention fits 1 sample: 1152 were tried," in done.stdout
    assert "Nearest: xyz extrinsic, passive, degrees, columns (a1, a2, a3)" in done.stdout
    assert "residual 0.0087 rad (0.5°), worst at sample 1" in done.stdout
    assert "as far off as that, --tolerance 0.0092 accepts it." in done.stdout
    assert done.stderr == ""
    call(*words, "--tolerance", "0.0092", cwd=tmp_path)
    far = call(*words[:2], "30,20,99", *words[3:], cwd=tmp_path, status=1)
    assert "Even the best match is" in far.stdout
    data = json.loads(call(*words, "--json", cwd=tmp_path, status=1).stdout)
    assert (data["fits"], data["answers"]) == (False, [])
    assert data["nearest"]["residual_rad"] == pytest.approx(np.radians(0.5))
