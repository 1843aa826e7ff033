#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace atrium::hull {

/// Sorts a list that is usually short and almost in order: up to 64 elements by insertion, longer
/// lists by std::sort. Not stable.
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
