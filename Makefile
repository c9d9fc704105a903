# bathyflash: each verb creates what it needs.
BIN := .venv/bin
READY := .venv/ready
DEMO := runs/demo
FLY := $(BIN)/bathyflash run scenarios/measured-seabed.toml -o $(DEMO)
OTHER_RUN := 5

SLOW := bad_input faults mutants physics regression scale scenarios statistics unit web

# Slow parts that leave cores idle fly two tests at once; what measures time stays alone.
TWO_BY_TEST := --numprocesses=2 --dist=worksteal
TWO_BY_FILE := --numprocesses=2 --dist=loadfile
ABREAST_bad_input := $(TWO_BY_TEST)
ABREAST_faults := $(TWO_BY_TEST)
ABREAST_physics := $(TWO_BY_FILE)
ABREAST_scenarios := $(TWO_BY_FILE)
ABREAST_unit := $(TWO_BY_FILE)

.PHONY: help venv libraries chromium demo gallery notebook test slow bench check format site figures web-bundle $(SLOW:%=slow-%)

help:
	@echo "make venv    create .venv with all libraries"
	@echo "make demo    fly a mission over a measured seabed and draw it: $(DEMO)/picture.png"
	@echo "make gallery fly every scenario, and draw and write docs/gallery.md anew: half an hour"
	@echo "make notebook execute docs/notebook.ipynb anew"
	@echo "make check   format, lint, types and direction of imports"
	@echo "make test    check, then all tests but the slow ones"
	@echo "make slow    the slow tests; one part alone: make slow-NAME, $(SLOW)"
	@echo "make bench   how fast engine, kernels and products are: nothing else should run"
	@echo "make site    the documentation as web pages, site/index.html: no network, no server"
	@echo "make figures draw the figures of the page on validation anew"
	@echo "make web-bundle  build the three.js of the web page anew with npm, and compare"
	@echo "make format  bring the code into its format"

venv: $(READY)

$(READY): requirements.lock pyproject.toml tools/create_environment.sh
	@tools/create_environment.sh
	@touch $@

libraries:
	@tools/system_libraries.sh

chromium:
	@tools/chromium.sh

# A demo of older code is flown anew.
demo: libraries $(READY)
	$(FLY) || { [ $$? -eq $(OTHER_RUN) ] && rm -rf $(DEMO) && $(FLY); }
	$(BIN)/bathyflash view $(DEMO) --screenshot $(DEMO)/picture.png
	@echo "picture: $(DEMO)/picture.png"

# Goes on where it was stopped.
gallery: libraries $(READY)
	$(BIN)/python -m tools.gallery

notebook: libraries $(READY)
	$(BIN)/python -m tools.notebook

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test: libraries chromium check
	$(BIN)/python -m pytest -m "not slow" --numprocesses=auto --maxprocesses=4 --dist=loadfile

slow: $(SLOW:%=slow-%)

$(SLOW:%=slow-%): slow-%: libraries $(READY)
	$(BIN)/python -m pytest -m slow tests/$* $(ABREAST_$*)

bench: $(READY)
	$(BIN)/python tests/benchmarks/kernels.py
	$(BIN)/python tests/benchmarks/products.py
	$(BIN)/python tests/benchmarks/window.py
	$(BIN)/bathyflash bench

format: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

site: $(READY)
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs --quiet build --strict
	@echo "pages: site/index.html"

figures: $(READY)
	$(BIN)/python -m tools.validation_figures

web-bundle:
	@tools/web_bundle/rebuild.sh
