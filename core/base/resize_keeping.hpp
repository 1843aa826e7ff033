#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace atrium {

/// Resizes `values` but keeps the memory of its elements: surplus elements move to `spare`, and
/// return from there before new ones are constructed. Returned elements have their old contents.
template <typename T>
void resize_keeping(std::vector<T>& values, std::size_t size, std::vector<T>& spare) {
    while (values.size() > size) {
        spare.push_back(std::move(values.back()));
        values.pop_back();
    }
    while (values.size() < size) {
        if (spare.empty()) {
            values.emplace_back();
        } else {
            values.push_back(std::move(spare.back()));
            spare.pop_back();
        }
    }
}

}  // namespace atrium
