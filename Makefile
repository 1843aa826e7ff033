# Each target is one command that works by itself; see README.md.
BUILD ?= build
SECONDS ?= 20
DEMO_OPTIONS ?=
SECURITY ?= 0
RUNS ?= 1
PATIENCE ?= 120

.PHONY: deb container demo test test-all bench bench-demo instructions format build programs
build:
	deploy/build.sh $(BUILD)

# half of the work: without the tests
programs:
	TARGETS=programs deploy/build.sh $(BUILD)

# make demo SECONDS=60, or SECONDS=0 to run until Ctrl-C; SECURITY=1 encrypts everything, with keys for this run
demo: programs
	$(BUILD)/bin/demo --seconds $(SECONDS) $(if $(filter-out 0,$(SECURITY)),--secured) $(DEMO_OPTIONS)

# what a contributor runs after each change; `ctest --test-dir build -L slow` is the rest
test: build
	ctest --test-dir $(BUILD) --output-on-failure -j $$(nproc) -LE slow

test-all: build
	ctest --test-dir $(BUILD) --output-on-failure -j $$(nproc)

bench:
	deploy/build.sh $(BUILD) -DATRIUM_BENCH=ON
	bench/run.sh $(BUILD)

# measures the demo when the machine is idle, keeps the figures in bench/results and renews README's table: make bench-demo RUNS=3
bench-demo: programs
	bench/bench_demo.py --build $(BUILD) --seconds $(SECONDS) --runs $(RUNS) --patience $(PATIENCE)

# instructions per metaframe of each program beside those kept in bench/instructions.json; fails beyond +15 %
instructions:
	TARGETS="programs metaframe_work" deploy/build.sh $(BUILD)
	bench/instructions.sh $(BUILD)

# packages/*.deb, the Debian packages of this tree: docs/packages.md
deb:
	deploy/make_deb.sh

# the image localhost/atrium, by podman, with these packages
container: deb
	deploy/make_container.sh

format:
	git ls-files '*.cpp' '*.hpp' | xargs clang-format -i
