#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace atrium::hull {

/// Sorts lists that are short as a rule, and often almost in order: by insertion, which is fastest
/// then. Long ones are left to std::sort. Equal elements end in no particular order.
template <typename Element, typename Before>
void sort_few(std::span<Element> list, const Before& before) {
    constexpr std::size_t kFew = 64;
    if (list.size() > kFew) {
        std::sort(list.begin(), list.end(), before);
        return;
    }
    for (std::size_t i = 1; i < list.size(); ++i) {
        const Element element = list[i];
        std::size_t at = i;
        for (; at > 0 && before(element, list[at - 1]); --at) list[at] = list[at - 1];
        list[at] = element;
    }
}

}  // namespace atrium::hull
