# robomech_ros: `make help` lists what can be made.

# A ROS distribution sourced in the shell sets ROS_DISTRO, too; only without one is it our choice.
SOURCED := $(filter-out $(CURDIR)/%,$(subst :, ,$(AMENT_PREFIX_PATH) $(COLCON_PREFIX_PATH)))
ifneq ($(SOURCED),)
ifeq ($(origin ROS_DISTRO),environment)
ROS_DISTRO := kilted
endif
endif
ROS_DISTRO ?= kilted
ifeq ($(filter kilted jazzy,$(ROS_DISTRO)),)
$(error ROS_DISTRO=$(ROS_DISTRO): the wheels are those of kilted and jazzy; on another distribution build with colcon)
endif
ROBOT ?= puma560

VENV_kilted := .venv
VENV_jazzy := .venv-jazzy
VENV := $(VENV_$(ROS_DISTRO))
OTHER := $(filter-out $(ROS_DISTRO),kilted jazzy)

# Every command runs without the environment of a sourced distribution.
RUN := sh tools/run.sh
BIN := $(RUN) $(VENV)/bin
PYTEST := $(BIN)/python -m pytest
# $(call set_up,environment,options)
set_up = python=$$($(RUN) sh tools/find_python.sh $(1) "$(PYTHON)") && \
    $(RUN) "$$python" tools/set_up.py $(1) $(2)

# Tests share no files and no ROS domain, so that each core runs some of them. Those of nodes wait for
# one another and, where robots move, for the clock, and leave much of the processor: what computes
# runs beside them, and only where they do not.
# A slow test has to earn its seconds: each row lists those that take longest.
LONGEST := --durations 40 --durations-min 5
PARALLEL := -n auto --maxprocesses 8 -rs $(LONGEST)
# A test of what takes the rest may wait minutes for the processor; the limit is for those that never end.
PATIENT := --timeout 1800
COMPUTING := $(PARALLEL) $(PATIENT) --ignore=test/nodes --ignore=test/installed --ignore=test/rvs
# Nodes and robots mostly wait: three workers keep two cores no more than half busy.
WAITING := -n $(shell echo $$(($$(nproc) < 8 ? $$(nproc) + 1 : 8))) -rs $(LONGEST)
ANSWERING := $(WAITING) --ignore=test/nodes/motion test/nodes test/rvs
# Where Fast DDS takes a process down while a participant leaves, the test that ran
# is named, and the others go on; not so with --dist loadgroup, which then hangs.
MOVING := -n 3 -rs $(LONGEST) test/nodes/motion
INSTALLED := $(PARALLEL) test/installed
# What takes long without computing: robots that move, browsers, processes.
QUICK := --ignore=test/nodes/motion --ignore=test/rvs/in_chromium --ignore=test/installed
LEFT := $(if $(shell command -v chrt),chrt --idle 0,nice -n 19)
# Each prints when it has ended.
AT_ONCE := $(MAKE) --no-print-directory -j2 -Otarget
# Options of pytest that choose tests.
CHOSEN := -m "not long"

# What runs once more without numba: the same sources as plain Python.
INTERPRETED := test/kinematics/test_forward.py test/robots/test_dh_recovery.py \
    test/kinetostatics/test_jacobian.py test/kinetostatics/test_accelerations.py

.DEFAULT_GOAL := help
.PHONY: help setup compat setup-demo setup-other notice demo view test test-fast test-long fuzz faults load plans soak clients moving answering installed other beside computing lint colcon bench pictures docs clean

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' Makefile
	@echo "  ROBOT=ur5e or a path to a URDF chooses the robot of the demo;"
	@echo "  ROS_DISTRO=jazzy works with the wheels of Jazzy in .venv-jazzy;"
	@echo "  PYTHON=python3.12 chooses the Python that the environment is made from."

notice:
	@$(if $(SOURCED),echo "setup: a ROS distribution is sourced here and kept out of this; to build on it: colcon build",:)

setup: notice ## make .venv: ROS 2 from wheels, interfaces, package, message types of MoveIt and ros2_control, kernels
	@$(call set_up,$(VENV),--distribution $(ROS_DISTRO))
	@$(if $(MAKECMDGOALS:setup=),:,echo "next: make demo ROBOT=ur5e shows all of it at work; make test checks it (make help lists more)")
	@$(if $(MAKECMDGOALS:setup=),:,echo "      or: . $(VENV)/bin/activate && robomech bringup --robot ur5e, then robomech call in another shell")

# As it was called before `make setup` did it.
compat: setup

setup-other: notice
	@$(call set_up,$(VENV_$(OTHER)),--distribution $(OTHER))

# What needs no message types of others, and few kernels, does not wait until all are built.
setup-demo: notice
	@$(call set_up,$(VENV),--distribution $(ROS_DISTRO) --for-demo "$(ROBOT)")

demo: setup-demo ## bring everything up, solve, plan, execute and check a pick and place
	@$(BIN)/robomech demo --robot "$(ROBOT)"

view: setup-demo ## see and move a robot in the browser, without ROS
	@$(BIN)/robomech view --robot "$(ROBOT)"

test: setup ## everything: lint, all tests, colcon, the other distribution
	@echo "test: robots move and nodes answer while lint, the other distribution and what computes take the rest"
	@$(AT_ONCE) installed beside

test-fast: setup ## what a developer runs again and again: one case of each test that is quick
	$(PYTEST) -q -m "not slow and not long" --cases 1 $(WAITING) $(QUICK) test

# Two rows: one after the other what has the processor first, and what takes the rest.
moving:
	$(PYTEST) $(CHOSEN) $(MOVING)

answering: moving
	$(PYTEST) $(CHOSEN) $(ANSWERING)

installed: answering other
	$(PYTEST) $(CHOSEN) $(INSTALLED)

other:
	@$(LEFT) $(MAKE) --no-print-directory lint setup-other

beside: other
	$(RUN) NUMBA_DISABLE_JIT=1 $(LEFT) $(VENV)/bin/python -m pytest -q -n 0 -rs $(LONGEST) $(PATIENT) $(INTERPRETED)
	@$(MAKE) --no-print-directory computing

computing:
	$(RUN) $(LEFT) $(VENV)/bin/python -m pytest $(CHOSEN) $(COMPUTING)

test-long: setup ## what takes minutes a test, and large counts: random cases by the thousand
	$(PYTEST) -m long $(COMPUTING)
	$(PYTEST) -m long test/installed

fuzz: setup ## attack the suite: random requests, goals, messages and bytes; COUNT=100000 SEED=0 ROBOT=puma560
	$(BIN)/python test/fuzz --count "$(or $(COUNT),100000)" --seed "$(or $(SEED),0)" --robot "$(ROBOT)"

plans: setup ## random plans of every profile, measured; COUNT=1000000 SEED=0 PROFILE=double_s
	$(BIN)/python test/many_plans --count "$(or $(COUNT),1000000)" --seed "$(or $(SEED),0)" \
	    --profile "$(PROFILE)"

soak: setup ## use the suite for half an hour, and see what its nodes hold; MINUTES=30 SEED=0 WILD=1
	$(BIN)/python test/soak --minutes "$(or $(MINUTES),30)" --seed "$(or $(SEED),0)" --robot "$(ROBOT)" \
	    $(if $(WILD),--wild)

clients: setup ## ten clients of MoveIt at once while objects come and go at 50 Hz; SECONDS=180 SEED=0
	$(BIN)/python test/foreign_clients --seconds "$(or $(SECONDS),180)" --seed "$(or $(SEED),0)"

load: setup ## 1,000 calls at once of every service, floods of every topic; COUNT=1000 SECONDS=10 ROBOT=puma560
	$(BIN)/python test/load --count "$(or $(COUNT),1000)" --seconds "$(or $(SECONDS),10)" \
	    --rate "$(or $(RATE),1000)" --only "$(ONLY)" --robot "$(ROBOT)"

faults: setup ## kill, end and hold up every node in mid motion, step its clock; ONLY='servo.*kill' chooses, ROBOT=puma560
	$(BIN)/python test/faults --only "$(ONLY)" --robot "$(ROBOT)"

lint: setup ## ruff, mypy and import-linter
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@if $(BIN)/python -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then \
	    echo "$(BIN)/mypy"; $(BIN)/mypy; \
	else \
	    echo "lint: types are checked on Python 3.11 and newer, numpy's types for 3.10 are too coarse"; \
	fi
	$(BIN)/lint-imports

colcon: setup ## build both packages with colcon in a scratch workspace and start a node from there
	$(PYTEST) -v test/installed/test_colcon.py

bench: setup ## measure against Pinocchio, EAIK, ssik and others and a bare rclpy service, in .venv-bench; BENCH="--only view"
	@$(call set_up,.venv-bench,--extra bench.txt)
	@$(RUN) .venv-bench/bin/python test/benchmark --ros-python $(VENV)/bin/python $(BENCH)

pictures: setup ## remake the pictures of the browser view in doc/images, by a headless Chromium
	$(BIN)/python test/pictures $(if $(ONLY),--only $(ONLY))

# Old pages are removed: notebooks depend on the library, and entries on the sections that name them.
docs: ## build the pages of doc/ into doc/_build and check them, in .venv-docs
	@$(call set_up,.venv-docs,--extra docs.txt)
	rm -rf doc/_build doc/api doc/jupyter_execute
	$(RUN) .venv-docs/bin/python -m sphinx -W --keep-going -q -j auto doc doc/_build
	$(RUN) .venv-docs/bin/python -m pytest -q -n0 test/test_built_documents.py
	@echo "docs: doc/_build/index.html"

clean: ## remove the environments and all that was built
	rm -rf .venv .venv-jazzy .venv-bench .venv-docs build install log dist demo_output doc/_build doc/api doc/jupyter_execute \
	    *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
	find robomech_ros test tools -name __pycache__ -prune -exec rm -rf {} +
