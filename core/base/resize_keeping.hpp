#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace atrium {

/// Resizes `values`, whose elements own memory that is worth keeping: those that are too many wait
/// in `spare`, as they are, and come back before new ones are made. Elements that are added hold
/// whatever they did.
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
