#pragma once

#include <cstddef>
#include <type_traits>

namespace atrium {

/// Runs independent tasks. Libraries take one; only programs own the threads behind it.
class Executor {
public:
    /// A task body that is called as `(task, worker)`, worker < num_workers(). A view: it stores
    /// nothing.
    class Body {
    public:
        template <typename F>
        requires(!std::is_same_v<std::remove_const_t<F>, Body>)
            // NOLINTNEXTLINE(google-explicit-constructor): made to be passed a lambda
            Body(F& body)
            : context_(const_cast<void*>(static_cast<const void*>(&body))),
              call_([](void* context, std::size_t task, std::size_t worker) {
                  (*static_cast<F*>(context))(task, worker);
              }) {}
        void operator()(std::size_t task, std::size_t worker) const {
            call_(context_, task, worker);
        }

    private:
        void* context_;
        void (*call_)(void*, std::size_t, std::size_t);
    };

    virtual ~Executor() = default;

    /// At least 1. Two tasks that run at the same time have different worker numbers.
    virtual std::size_t num_workers() const = 0;

    /// Calls `body` once for every task in [0, num_tasks), in any order, and returns when all are
    /// done. What `body` throws (want of memory) is thrown again here, once no worker is in `body`
    /// any more; some tasks may then never have begun.
    virtual void parallel_for(std::size_t num_tasks, Body body) = 0;

    /// A task that takes long calls this every few tens of microseconds with its worker number.
    /// More urgent tasks of other callers may run here before it returns.
    virtual void give_way(std::size_t /*worker*/) {}
};

/// `Executor::give_way` of one task, to be passed on to what takes long in it. By default it does
/// nothing.
struct GiveWay {
    Executor* executor = nullptr;
    std::size_t worker = 0;

    void operator()() const {
        if (executor != nullptr) executor->give_way(worker);
    }
};

/// Everything on the calling thread, in order.
class SerialExecutor final : public Executor {
public:
    std::size_t num_workers() const override { return 1; }
    void parallel_for(std::size_t num_tasks, Body body) override {
        for (std::size_t task = 0; task < num_tasks; ++task) body(task, 0);
    }
};

}  // namespace atrium
