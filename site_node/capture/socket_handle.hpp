#pragma once

#include <unistd.h>

namespace atrium::capture {

/// Closes a socket.
class SocketHandle {
public:
    /// Below 0: there is none.
    explicit SocketHandle(int descriptor) : descriptor_(descriptor) {}
    ~SocketHandle() {
        if (descriptor_ >= 0) close(descriptor_);
    }
    SocketHandle(const SocketHandle&) = delete;
    SocketHandle& operator=(const SocketHandle&) = delete;

    int get() const { return descriptor_; }

private:
    int descriptor_;
};

}  // namespace atrium::capture
