#pragma once

#include <arv.h>

#include <memory>
#include <string>

namespace atrium::capture {

struct Unref {
    void operator()(void* object) const { g_object_unref(object); }
};
/// Owns one reference of a GObject.
template <typename T>
using GPtr = std::unique_ptr<T, Unref>;

/// Receives the error of a GLib call.
class GErrorSlot {
public:
    GErrorSlot() = default;
    ~GErrorSlot() { g_clear_error(&error_); }
    GErrorSlot(const GErrorSlot&) = delete;
    GErrorSlot& operator=(const GErrorSlot&) = delete;

    /// Returns the output argument for the next call; clears the previous error.
    GError** out() {
        g_clear_error(&error_);
        return &error_;
    }
    bool failed() const { return error_ != nullptr; }
    std::string message() const { return error_ == nullptr ? "unknown" : error_->message; }

private:
    GError* error_ = nullptr;
};

}  // namespace atrium::capture
