# Each target is one command that works by itself; see README.md.
BUILD ?= build
SECONDS ?= 20
DEMO_OPTIONS ?=

.PHONY: demo test bench format build programs
build:
	deploy/build.sh $(BUILD)

# half of the work: without the tests
programs:
	TARGETS=programs deploy/build.sh $(BUILD)

# make demo SECONDS=60, or SECONDS=0 to run until Ctrl-C
demo: programs
	$(BUILD)/bin/demo --seconds $(SECONDS) $(DEMO_OPTIONS)

test: build
	ctest --test-dir $(BUILD) --output-on-failure -j $$(nproc)

bench:
	deploy/build.sh $(BUILD) -DATRIUM_BENCH=ON
	bench/run.sh $(BUILD)

format:
	git ls-files '*.cpp' '*.hpp' | xargs clang-format -i
