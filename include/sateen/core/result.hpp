// SPDX-License-Identifier: Apache-2.0
// Errors as values: Result<T> is a T or an Error, with the member names of std::expected.
// Nothing in the runtime throws; front ends translate an Error once.
#pragma once

#include <cstdlib>
#include <string>
#include <utility>
#include <variant>

namespace sateen {

/// What kind of failure it is; the message says what happened.
enum class Errc {
    io,                ///< the file system said no
    bad_format,        ///< bytes that are not what they should be
    unsupported,       ///< well-formed, but nothing here can read or draw it
    limit_exceeded,    ///< larger than a stated limit
    invalid_argument,  ///< an option out of its range
    singular,          ///< a system of equations without a solution
    not_stationary,    ///< a field that would diverge when drawn
    cancelled,         ///< the caller asked to stop
};

/// A failure: what went wrong, where (file, table, field, option), found versus expected.
struct Error {
    Errc code = Errc::io;
    std::string message;
};

namespace detail {
/// Marks the success state of Result<void>.
struct Nothing {};
}  // namespace detail

/// A value or an Error. Accessing the value of a failure aborts: it is a bug in the
/// caller.
template <class T>
class [[nodiscard]] Result {
    using Stored = std::conditional_t<std::is_void_v<T>, detail::Nothing, T>;

  public:
    using value_type = T;

    Result() requires std::is_void_v<T> : state_(std::in_place_index<0>) {}
    template <class U = Stored>
    requires(!std::is_void_v<T> && std::is_constructible_v<Stored, U&&> &&
             !std::is_same_v<std::remove_cvref_t<U>, Result> &&
             !std::is_same_v<std::remove_cvref_t<U>, Error>)
        // NOLINTNEXTLINE(bugprone-forwarding-reference-overload): constrained above
        Result(U&& value)
        : state_(std::in_place_index<0>, std::forward<U>(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    [[nodiscard]] bool has_value() const noexcept { return state_.index() == 0; }
    [[nodiscard]] explicit operator bool() const noexcept { return has_value(); }

    [[nodiscard]] Stored& operator*() & { return *checked(); }
    [[nodiscard]] const Stored& operator*() const& { return *checked(); }
    [[nodiscard]] Stored&& operator*() && { return std::move(*checked()); }
    [[nodiscard]] Stored* operator->() { return checked(); }
    [[nodiscard]] const Stored* operator->() const { return checked(); }

    [[nodiscard]] const Error& error() const& {
        const Error* error = std::get_if<1>(&state_);
        if (error == nullptr) std::abort();
        return *error;
    }
    [[nodiscard]] Error&& error() && {
        Error* error = std::get_if<1>(&state_);
        if (error == nullptr) std::abort();
        return std::move(*error);
    }

    template <class F>
    [[nodiscard]] auto and_then(F&& next) && -> std::invoke_result_t<F, Stored&&> {
        if (!has_value()) return std::move(*this).error();
        return std::forward<F>(next)(std::move(**this));
    }
    template <class F>
    [[nodiscard]] auto transform(
        F&& map) && -> Result<std::invoke_result_t<F, Stored&&>> {
        if (!has_value()) return std::move(*this).error();
        return std::forward<F>(map)(std::move(**this));
    }

  private:
    Stored* checked() {
        Stored* value = std::get_if<0>(&state_);
        if (value == nullptr) std::abort();
        return value;
    }
    const Stored* checked() const {
        const Stored* value = std::get_if<0>(&state_);
        if (value == nullptr) std::abort();
        return value;
    }

    std::variant<Stored, Error> state_;
};

}  // namespace sateen

#define SATEEN_CONCAT_IMPL(a, b) a##b
#define SATEEN_CONCAT(a, b) SATEEN_CONCAT_IMPL(a, b)

/// SATEEN_TRY(declaration, expression): declares the value of a Result, or returns its
/// Error.
#define SATEEN_TRY(declaration, ...)                                    \
    auto&& SATEEN_CONCAT(sateen_try_, __LINE__) = (__VA_ARGS__);        \
    if (!SATEEN_CONCAT(sateen_try_, __LINE__))                          \
        return std::move(SATEEN_CONCAT(sateen_try_, __LINE__)).error(); \
    declaration = *std::move(SATEEN_CONCAT(sateen_try_, __LINE__))

/// SATEEN_CHECK(expression): returns the Error of a Result<void>, or goes on.
#define SATEEN_CHECK(...)                                 \
    if (auto sateen_check = (__VA_ARGS__); !sateen_check) \
    return std::move(sateen_check).error()
