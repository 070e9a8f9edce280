// SPDX-License-Identifier: Apache-2.0
// directions.csv. See direction_names.hpp.
#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <span>
#include <utility>

#include "io/direction_names.hpp"
#include "io/text_lines.hpp"

namespace sateen::io {
namespace {

constexpr std::array<std::string_view, 5> kColumns = {"file", "theta_i", "phi_i",
                                                      "theta_v", "phi_v"};
constexpr std::array<std::string_view, 2> kOneDirection = {"theta", "phi"};
constexpr std::string_view kExpectedHeader = "file,theta_i,phi_i,theta_v,phi_v";

/// Cuts at commas outside quotes; "" inside quotes is a quote. Nothing if a quote is
/// open.
std::optional<std::vector<std::string>> split(std::string_view line) {
    std::vector<std::string> fields;
    for (;;) {
        std::string field;
        line = trimmed(line);
        if (!line.empty() && line.front() == '"') {
            line.remove_prefix(1);
            for (;;) {
                const std::size_t quote = line.find('"');
                if (quote == std::string_view::npos) return std::nullopt;
                field += line.substr(0, quote);
                line.remove_prefix(quote + 1);
                if (line.empty() || line.front() != '"') break;
                field += '"';
                line.remove_prefix(1);
            }
        }
        const std::size_t comma = line.find(',');
        field += trimmed(line.substr(0, comma));
        fields.push_back(std::move(field));
        if (comma == std::string_view::npos) return fields;
        line.remove_prefix(comma + 1);
    }
}

using Columns = std::vector<std::size_t>;
using Names = std::span<const std::string_view>;

/// Where the columns of these names are; or the name of one that is missing.
struct Header {
    Columns columns;
    std::string_view missing;
};

Header find_columns(std::string_view line, Names names) {
    std::vector<std::string> titles = split(line).value_or(std::vector<std::string>());
    for (std::string& title : titles)
        for (char& c : title)
            if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    Header header;
    for (const std::string_view name : names) {
        const auto found = std::find(titles.begin(), titles.end(), name);
        if (found == titles.end()) return {{}, name};
        header.columns.push_back(static_cast<std::size_t>(found - titles.begin()));
    }
    return header;
}

Error no_column(std::string_view file, std::string_view column,
                std::string_view expected) {
    return {Errc::bad_format, std::string(file) + ": found no column '" +
                                  std::string(column) +
                                  "' in the first line, expected the header '" +
                                  std::string(expected) + "'"};
}

std::optional<double> to_number(const std::string& text) {
    const char* const end = text.data() + text.size();
    const char* begin = text.data();
    if (begin != end && *begin == '+') ++begin;
    double value = 0;
    const auto [rest, code] = std::from_chars(begin, end, value);
    if (code != std::errc() || rest != end) return std::nullopt;
    return value;
}

/// The fields of a line in the given columns; or what is wrong with it.
struct Fields {
    std::vector<std::string> values;
    std::string problem;
};

Fields pick_fields(std::string_view line, const Columns& columns) {
    const auto fields = split(line);
    if (!fields) return {{}, "found an open quote, expected it closed on the same line"};
    if (fields->size() <= *std::max_element(columns.begin(), columns.end()))
        return {{},
                "found " + std::to_string(fields->size()) +
                    " fields, expected as many as in the header"};
    Fields picked;
    for (const std::size_t column : columns) picked.values.push_back((*fields)[column]);
    return picked;
}

/// The direction in two fields; what is wrong goes to `problem`, unless it has a text.
DirectionKey parse_key(std::span<const std::string> texts, Names names, const char* whose,
                       std::string& problem) {
    std::array<double, 2> angles = {};
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const std::optional<double> value = to_number(texts[i]);
        if (!value && problem.empty())
            problem =
                std::string(names[i]) + ": found '" + texts[i] + "', expected degrees";
        angles[i] = value.value_or(0);
    }
    if (!problem.empty()) return {};
    auto key = direction_key(angles[0], angles[1]);
    if (!key) problem = whose + key.error().message;
    return key ? *key : DirectionKey();
}

/// The last four columns are angles; a column before them is the file.
CsvRow parse_row(std::string_view line, std::size_t line_number, const Columns& columns) {
    CsvRow row;
    row.line = line_number;
    Fields fields = pick_fields(line, columns);
    row.problem = fields.problem;
    if (!row.problem.empty()) return row;
    const bool has_file = columns.size() == kColumns.size();
    if (has_file) row.file = fields.values[0];
    if (has_file && row.file.empty()) row.problem = "found an empty file name";
    const std::span<const std::string> angles =
        std::span<const std::string>(fields.values).last(4);
    const Names names = Names(kColumns).last(4);
    row.directions.light =
        parse_key(angles.first(2), names.first(2), "light: ", row.problem);
    row.directions.view = parse_key(angles.last(2), names.last(2), "view: ", row.problem);
    return row;
}

/// Calls `use(line, number)` for every line that is not blank or a comment, the first of
/// which is the header.
template <class F>
void for_each_line(std::string_view text, const F& use) {
    skip_byte_order_mark(text);
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::string_view line = next_line(text);
        if (!line.empty() && line.front() != '#') use(line, number);
    }
}

/// All pairs of one list. A pair has the line of its light.
std::vector<CsvRow> all_pairs(const std::vector<CsvRow>& list) {
    std::vector<CsvRow> pairs;
    for (const CsvRow& light : list) {
        if (!light.problem.empty()) return {light};
        for (const CsvRow& view : list) {
            pairs.push_back(light);
            pairs.back().directions.view = view.directions.light;
        }
    }
    return pairs;
}

}  // namespace

Result<std::vector<CsvRow>> parse_directions_csv(std::string_view text,
                                                 std::string_view name) {
    std::optional<Header> header;
    std::vector<CsvRow> rows;
    for_each_line(text, [&](std::string_view line, std::size_t number) {
        if (!header)
            header = find_columns(line, kColumns);
        else if (header->missing.empty())
            rows.push_back(parse_row(line, number, header->columns));
    });
    if (!header)
        return Error{Errc::bad_format, std::string(name) +
                                           ": is empty, expected the header '" +
                                           std::string(kExpectedHeader) + "'"};
    if (!header->missing.empty())
        return no_column(name, header->missing, kExpectedHeader);
    return rows;
}

Result<std::vector<CsvRow>> parse_direction_pairs(std::string_view text,
                                                  std::string_view name) {
    constexpr std::string_view kExpected = "theta,phi' or 'theta_i,phi_i,theta_v,phi_v";
    std::optional<Header> pair;
    std::optional<Header> single;
    std::vector<CsvRow> rows;
    for_each_line(text, [&](std::string_view line, std::size_t number) {
        if (!pair) {
            pair = find_columns(line, Names(kColumns).last(4));
            single = find_columns(line, kOneDirection);
        } else if (pair->missing.empty()) {
            rows.push_back(parse_row(line, number, pair->columns));
        } else if (single->missing.empty()) {
            CsvRow row;
            row.line = number;
            const Fields fields = pick_fields(line, single->columns);
            row.problem = fields.problem;
            if (row.problem.empty())
                row.directions.light =
                    parse_key(fields.values, kOneDirection, "", row.problem);
            rows.push_back(row);
        }
    });
    if (!pair)
        return Error{Errc::bad_format, std::string(name) +
                                           ": is empty, expected the header '" +
                                           std::string(kExpected) + "'"};
    if (pair->missing.empty()) return rows;
    if (!single->missing.empty()) return no_column(name, single->missing, kExpected);
    return all_pairs(rows);
}

}  // namespace sateen::io
