# Everything runs in .venv inside the checkout, made on first use. `make` alone lists the targets.
# A machine needs Python 3.11 to 3.14, make, and the network for the first run.

VENV := .venv
PY := $(VENV)/bin/python
TORSIONBOOK := $(VENV)/bin/torsionbook
RUN_READY := $(VENV)/.ready-run
DEV_READY := $(VENV)/.ready-dev
# A checkout that was moved or copied together with its .venv gets a new one.
MOVED := $(shell [ ! -e $(VENV)/.checkout ] || [ "$$(cat $(VENV)/.checkout)" = "$$(pwd -P)" ] || echo moved)
# The loops in C: compiled again where their sources are newer.
LOOPS := engine/stepping/kernels/_declarations.py
SETUP := pyproject.toml scripts/make_venv.sh $(MOVED)

# Test processes: one a core, four at most (make test JOBS=1 for a debugger). Each begins with a
# stretch of files and makes their shared workbooks once; who is done takes from the others.
JOBS := auto
# Where no bytecode may be written, each process would rewrite the assertions of all tests anew.
PYTEST_PY := env -u PYTHONDONTWRITEBYTECODE $(PY)
PROCESSES := -n $(JOBS) --maxprocesses 4 --dist worksteal
# More words for pytest: make test ARGS="tests/boundaries -x"
ARGS :=
# How long make explore looks for new examples: make explore MINUTES=30
MINUTES := 10
# More words for the lock: make lock LOCK="--upgrade"
LOCK :=

# A checkout to measure beside, and more words for its measurement: make goals OTHER=/tmp/old GOALS="--only warm"
OTHER :=
GOALS :=

# Trials of each class, or trains: make calibration-study TRIALS=200
TRIALS :=

.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: help demo test slow-tests test-long test-machines explore validate kills fuzz check format docs bench goals calibration-study sensitivity-study mutations generated templates wheel wheels same-bits sanitize smoke windows front-windows kills-windows zips lock clean distclean moved

help:
	@echo "make demo           recalculate two example workbooks into build/demo"
	@echo "make test           run the tests"
	@echo "make slow-tests     run the tests and note which are too dear for the default run"
	@echo "make test-long      run the tests over hundreds of trains, of which CI runs a sample"
	@echo "make test-machines  repeat the numerical tests as other processors would calculate"
	@echo "make explore        run the properties with fresh examples (MINUTES=30)"
	@echo "make validate       write every kind of file and have programs of others judge them (needs Java, Maven, npm)"
	@echo "make kills          kill commands at every file call, fail calls, fill disks, cut the power (needs Linux, a C compiler)"
	@echo "make fuzz           50,000 spoiled workbooks (FIRST=2000 COUNT=1000)"
	@echo "make check          style, formatting and types"
	@echo "make format         put the formatting right"
	@echo "make docs           the pages of docs/ as a site with search, in build/site"
	@echo "make bench          time and accuracy, side by side with other programs"
	@echo "make goals          the goals of the compiled loops, beside a checkout of 011f76f (OTHER=/path/to/it)"
	@echo "make calibration-study  how often the intervals of a calibration hold the truth (TRIALS=1000)"
	@echo "make sensitivity-study  how often the stated errors of sensitivities hold (TRIALS=100)"
	@echo "make mutations      calculate spoiled cases: named problems or finite results (FIRST=2000 CASES=1000)"
	@echo "make templates      rebuild the workbooks in templates/"
	@echo "make wheel          build the wheel into build/dist"
	@echo "make wheels         build the wheels of all systems into build/wheels, and look into each"
	@echo "make same-bits      calculate with every compiler here and as other processors would: equal to the bit"
	@echo "make sanitize       the tests of the loops with memory and arithmetic watched (needs gcc)"
	@echo "make smoke          install that wheel outside the checkout and use it"
	@echo "make windows        tests in a Windows Python under Wine (ARGS=\"tests/xlsx\"; default: seven rooms, some kills, every function)"
	@echo "make kills-windows  kill commands at file calls under Wine (ARGS=\"--most 5 --only upgrade\")"
	@echo "make front-windows  every worksheet function under Wine, to the bit, into docs/fronts.md"
	@echo "make zips           zips for Windows and Linux with their own Python, into build/zips"
	@echo "make lock           lock the dependencies anew (LOCK=--upgrade for newer versions)"
	@echo "make clean          remove what was built; make distclean removes .venv as well"

demo: $(RUN_READY) $(LOOPS)
	@mkdir -p build/demo
	$(TORSIONBOOK) recalc templates/example_proposed.xlsx templates/example_modified.xlsx --out build/demo
	@echo
	@echo "The recalculated workbooks are in $(CURDIR)/build/demo:"
	@ls build/demo/*.xlsx
	@echo "Open the Summary sheet first. The inputs are the files of the same names in templates/."

test: $(DEV_READY) $(LOOPS)
	$(PYTEST_PY) -m pytest $(PROCESSES) $(ARGS)

slow-tests: $(DEV_READY) $(LOOPS)
	$(PYTEST_PY) -m pytest $(PROCESSES) -o junit_duration_report=call --junitxml=build/quick_tests.xml
	$(PY) scripts/slow_tests.py build/quick_tests.xml

test-long: $(DEV_READY) $(LOOPS)
	TORSIONBOOK_RUN_SLOW=1 TORSIONBOOK_RUN_LONG=1 $(PYTEST_PY) -m pytest -m long $(PROCESSES) $(ARGS)

test-machines: $(DEV_READY) $(LOOPS)
	$(PYTEST_PY) scripts/other_machines.py $(PROCESSES) $(ARGS)

explore: $(DEV_READY) $(LOOPS)
	$(PYTEST_PY) scripts/explore.py $(MINUTES) $(PROCESSES) $(ARGS)

validate: $(DEV_READY) $(LOOPS)
	$(PY) scripts/validate.py --all --record $(ARGS)

kills: $(DEV_READY) $(LOOPS)
	$(PY) -m benchmarks.file_calls --record $(ARGS)

fuzz: $(DEV_READY) $(LOOPS)
	$(PY) -m benchmarks.workbook_fuzz --run 2 --first $(or $(FIRST),0) --count $(or $(COUNT),50000) --record $(ARGS)

check: $(DEV_READY) $(LOOPS)
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	$(PY) -m mypy

format: $(DEV_READY) $(LOOPS)
	$(PY) -m ruff check --fix .
	$(PY) -m ruff format .

docs: $(DEV_READY)
	PYTHONPATH=scripts $(VENV)/bin/zensical build --clean --strict
	@echo "Open $(CURDIR)/build/site/index.html; it needs no server."

bench: $(DEV_READY) $(LOOPS)
	$(PY) -m benchmarks

goals: $(DEV_READY) $(LOOPS)
	@test -n "$(OTHER)" || { echo "Name a checkout of 011f76f in which make demo has run: make goals OTHER=/path/to/it" >&2; exit 2; }
	$(PY) -m benchmarks.goals_beside $(OTHER) $(GOALS)

calibration-study: $(DEV_READY) $(LOOPS)
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(PY) -m benchmarks.calibration_coverage $(TRIALS:%=--cases %)

sensitivity-study: $(DEV_READY) $(LOOPS)
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(PY) -m benchmarks.sensitivity_errors $(TRIALS:%=--trains %)

mutations: $(DEV_READY) $(LOOPS)
	$(PY) -m benchmarks.mutated_cases $(FIRST:%=--first %) $(CASES:%=--cases %) --record

generated: $(DEV_READY) $(LOOPS)
	$(PY) scripts/generated.py

templates: $(RUN_READY) $(LOOPS)
	$(PY) -m addin.template.build templates

wheel: $(RUN_READY) $(LOOPS)
	@rm -rf build/dist
	$(PY) -m pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation --wheel-dir build/dist .
	@ls build/dist/*.whl

wheels: $(RUN_READY) $(LOOPS)
	$(PY) -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/build.txt
	$(PY) scripts/wheels.py build/wheels

same-bits: $(DEV_READY) $(LOOPS)
	$(PY) -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/build.txt
	$(PY) scripts/same_bits.py $(ARGS)

sanitize: $(DEV_READY) $(LOOPS)
	scripts/sanitize.sh $(PY) $(PROCESSES)

smoke: wheel
	scripts/smoke_wheel.sh $(PY) build/dist/*.whl

windows: $(DEV_READY) $(LOOPS)
	$(PY) -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/build.txt
	$(PY) scripts/windows.py $(ARGS)
	$(if $(ARGS),,$(PY) -m benchmarks.wine_kills --only export --most 2)
	$(if $(ARGS),,$(PY) -m benchmarks.fronts --windows --check)

kills-windows: $(DEV_READY) $(LOOPS)
	$(PY) -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/build.txt
	$(PY) -m benchmarks.wine_kills --record $(ARGS)

front-windows: $(DEV_READY) $(LOOPS)
	$(PY) -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/build.txt
	$(PY) -m benchmarks.fronts --windows --write-docs

zips: $(DEV_READY) $(LOOPS)
	$(PY) -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/build.txt
	$(PY) scripts/zips.py build/zips $(ARGS)

lock: $(RUN_READY) $(LOOPS)
	$(PY) -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/lock.txt
	scripts/lock.sh $(PY) $(LOCK)

clean:
	rm -rf build .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -path ./$(VENV) -prune -o -type d -name __pycache__ -exec rm -rf {} +

distclean: clean
	rm -rf $(VENV)

# The stamps are younger than the lock files they were made from, so a second run starts at once.
$(RUN_READY): requirements/run.txt $(SETUP)
	@scripts/make_venv.sh requirements/run.txt
	@touch $@

$(DEV_READY): requirements/dev.txt $(SETUP)
	@scripts/make_venv.sh requirements/dev.txt
	@touch $@ $(RUN_READY)

$(LOOPS): hatch_build.py $(wildcard engine/stepping/kernels/*.c engine/stepping/kernels/*.h)
	@$(PY) hatch_build.py

moved:
	@echo "This checkout has moved since $(VENV) was made."
