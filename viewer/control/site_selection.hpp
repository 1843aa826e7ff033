#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace atrium::viewer {

/// The sites whose people the user wants to see. All at first. Not thread-safe.
class SiteSelection {
public:
    /// Hides the site, or shows it again. Ends a solo.
    void toggle(const std::string& site) {
        if (!solo_.empty()) {
            const bool was_alone = solo_ == site;
            solo_.clear();
            if (!was_alone) {
                hidden_.erase(site);
                return;
            }
        }
        if (hidden_.erase(site) == 0 && hidden_.size() < kMaxHidden) hidden_.insert(site);
    }
    /// Shows only this site, or all again that are not hidden.
    void toggle_solo(const std::string& site) { solo_ = solo_ == site ? "" : site; }

    bool shows(const std::string& site) const {
        return solo_.empty() ? !hidden_.contains(site) : solo_ == site;
    }
    const std::string& solo() const { return solo_; }  // empty: none

private:
    static constexpr std::size_t kMaxHidden = 1024;
    std::set<std::string> hidden_;
    std::string solo_;
};

}  // namespace atrium::viewer
