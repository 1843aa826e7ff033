#include "tools/doctor/report/report.hpp"

#include <nlohmann/json.hpp>

namespace atrium::doctor {

std::string report_json(std::span<const Finding> findings,
                        const std::vector<Checked>& checked,
                        const Roles& roles) {
    using nlohmann::ordered_json;
    ordered_json out;
    out["healthy"] = !is_ill(findings);
    out["roles"] = names_of(roles);
    out["findings"] = ordered_json::array();
    for (const Finding& finding : findings) {
        out["findings"].push_back(
            {{"id", finding.id},
             {"severity", name_of(finding.severity)},
             {"text", finding.text},
             {"cure", finding.cure},
             {"keep", finding.keep.empty() ? ordered_json() : ordered_json(finding.keep)}});
    }
    out["checked"] = ordered_json::array();
    for (const Checked& one : checked)
        out["checked"].push_back({{"what", one.what}, {"value", one.value}});
    // invalid UTF-8 is replaced, not thrown
    return out.dump(2, ' ', /*ensure_ascii=*/true, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace atrium::doctor
