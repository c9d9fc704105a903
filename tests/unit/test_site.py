"""The documentation site: complete where the code tells it, and without a network."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
import typer

from survey.cli import app
from survey.scenario.addresses import all_models
from survey.scenario.validate import SECTIONS
from tools.pages.command_reference import command_reference
from tools.pages.formulas import with_formulas
from tools.pages.notebook import notebook_page
from tools.pages.scenario_reference import (
    meaning_of,
    model_keys,
    scenario_reference,
    text_of,
    unit_of,
)

ROOT = Path(__file__).parents[2]
MODELS = sorted({model for _, model in all_models(SECTIONS)}, key=lambda model: model.__name__)
LOADED = re.compile(
    r"""<(?:script|link|img|iframe|source)\b[^>]*?(?:src|href)=["']?(\S+?)["'\s>]"""
)
PURE_NUMBERS = {
    "afterpulse_probability",
    "asymmetry",
    "backscatter_fraction",
    "backward_asymmetry",
    "buried_fraction",
    "column_spacing",
    "crosstalk_probability",
    "damping",
    "depolarisation",
    "false_alarm_rate",
    "fill_factor",
    "forward_asymmetry",
    "forward_share",
    "full_scale_photo_electrons",
    "gain",
    "group_index",
    "ionisation_ratio",
    "legendre_moment",
    "nodata",
    "optical_thickness",
    "optics_transmission",
    "particle_index",
    "particle_scattering_factor",
    "quantum_efficiency",
    "reef_reflectance",
    "reflectance",
    "refractive_index",
    "relief",
    "relief_spectral_slope",
    "roughness_spectral_slope",
    "scattering_fraction",
    "second_look_rate",
    "secondary_emission",
    "sidelap",
    "size_slope",
    "small_angle_slope",
    "water_reflectance",
}


@pytest.fixture(scope="module")
def reference() -> str:
    return scenario_reference()


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_every_key_has_a_meaning_and_a_row(model: Any, reference: str) -> None:
    assert meaning_of(model)
    for key in model_keys(model):
        text = text_of(model, key)
        assert text, key
        assert re.search(
            rf"^\| `{key}` \|.*\| {re.escape(text)} \|$", reference, flags=re.MULTILINE
        )


def test_every_number_with_a_unit_ends_in_it() -> None:
    bare = {
        key
        for model in MODELS
        for key in model_keys(model)
        if "float" in str(model.model_fields[key].annotation) and not unit_of(key)
    }
    assert bare == PURE_NUMBERS


def test_every_command_and_option_has_a_text_and_a_row() -> None:
    page, group = command_reference(), typer.main.get_command(app)
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        assert f"\n## {name}\n\n{command.help.strip()}" in page
        section = page.split(f"\n## {name}\n")[1].split("\n## ")[0]
        for param in command.params:
            assert param.help, f"{name} {param.name}"
            assert f" | {param.help}".replace("[", "\\[") in section


def test_formulas_are_pictures_with_their_number() -> None:
    html = r'<div class="arithmatex">\[ \frac{a}{b} &lt; c \tag{W1} \]</div>'
    drawn = with_formulas(html)
    assert drawn.count("<svg") == 1
    assert '<span class="number">(W1)</span>' in drawn
    assert r'aria-label="\frac{a}{b} &lt; c"' in drawn


def test_a_notebook_becomes_a_page_with_its_pictures(tmp_path: Path) -> None:
    output = nbformat.v4.new_output("display_data", {"image/png": "iVBORw0KGgo="})
    cell = nbformat.v4.new_code_cell("print(1)", outputs=[output])
    file = tmp_path / "notebook.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[cell]), file)
    page = notebook_page(file)
    text = str(page.pop("notebook.md"))
    assert "print(1)" in text
    (picture,) = page
    assert f"]({picture})" in text


@pytest.mark.slow
def test_the_site_is_built_strictly_and_loads_nothing_from_a_network(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    pages = list(tmp_path.glob("**/*.html"))
    assert len(pages) > 30
    for page in pages:
        html = page.read_text(encoding="utf-8")
        loaded = [place for place in LOADED.findall(html) if re.match(r"https?:|//", place)]
        assert loaded == [], page
        assert "arithmatex" not in html
    for style in tmp_path.glob("**/*.css"):
        assert not re.search(r"url\(['\"]?(https?:|//)", style.read_text(encoding="utf-8")), style
