#pragma once

#include "core/base/descriptor.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::test {

/// One camera's connection as a worker sees it. Reads and writes the bytes of
/// docs/segmentation_worker.md by itself, without the code under test.
class FakeConnection {
public:
    /// Takes the hello and the memory.
    explicit FakeConnection(Descriptor socket);
    ~FakeConnection();
    FakeConnection(const FakeConnection&) = delete;
    FakeConnection& operator=(const FakeConnection&) = delete;

    std::uint32_t width() const { return number32(24); }
    std::uint32_t height() const { return number32(28); }
    std::uint32_t number32(std::size_t offset) const;
    std::uint64_t number64(std::size_t offset) const;
    std::string text(std::size_t offset) const;
    /// A place of the header: 32 background, 40 picture, 48 last mask, 56 alpha.
    std::span<std::uint8_t> plane(std::size_t offset, std::size_t bytes_per_pixel) const;
    int memory() const { return memory_.get(); }
    std::size_t num_bytes() const { return num_bytes_; }

    struct Picture {
        std::uint32_t kind = 0;
        std::uint32_t version = 0;
        std::uint64_t number = 0;
        std::int64_t capture_time_ns = 0;
        std::uint32_t background_number = 0;
    };
    /// Waits for a message of the site; nullopt once it has closed the connection.
    std::optional<Picture> receive() const;

    void ready() const { send(message(1, 0)); }
    void answer(std::uint64_t number, std::uint8_t alpha) const;
    std::vector<std::uint8_t> message(std::uint32_t kind, std::uint64_t number) const;
    void send(const std::vector<std::uint8_t>& bytes) const;

private:
    Descriptor socket_;
    Descriptor memory_;
    std::uint8_t* bytes_ = nullptr;
    std::size_t num_bytes_ = 0;
};

/// Listens at a path, as a worker does.
class FakeWorker {
public:
    explicit FakeWorker(const std::filesystem::path& path);
    ~FakeWorker();

    /// Waits for the next connection.
    std::unique_ptr<FakeConnection> accept() const;
    /// Whether somebody is connecting now.
    bool has_visitor() const;

private:
    std::filesystem::path path_;
    Descriptor listener_;
};

}  // namespace atrium::test
