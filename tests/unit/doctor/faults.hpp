#pragma once

#include "tests/unit/doctor/fake_host.hpp"
#include "tools/doctor/checks/finding.hpp"

#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace atrium::doctor {

/// One fault of a healthy host.
struct Fault {
    std::string name;  // of the test
    std::string id;    // of the finding
    std::function<void(FakeHost&, Options&)> provoke;
    std::string text;  // parts of the finding
    std::string cure;
    std::string keep = {};  // empty: there must be none
};

inline void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

std::vector<Fault> network_faults();
std::vector<Fault> camera_faults();
std::vector<Fault> machine_faults();
std::vector<Fault> file_faults();
std::vector<Fault> host_faults();
std::vector<Fault> all_faults();

}  // namespace atrium::doctor
