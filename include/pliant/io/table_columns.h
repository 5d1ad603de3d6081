// The columns of a table, by pattern. Most columns repeat for every part or joint. A pattern has the column
// once, with "*" in place of the name of the part or joint, so that a list of columns stays short for many
// parts.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/io/format/column.h>

namespace pliant {

/// Consecutive columns of a table: columns of the table itself, or columns of each part or of each joint.
struct ColumnGroup {
  enum class Each { table, part, joint };

  Each each = Each::table;
  std::string set;  ///< name of these columns in the kinds of layout.json; empty for Each::table
  /// Returns the columns of the part or joint with this index of the model, with "*" in place of its name.
  /// For Each::table the index is 0.
  std::function<std::vector<Column>(std::size_t)> columns;
};

using TableColumns = std::vector<ColumnGroup>;

/// Returns a group of columns of the table itself.
ColumnGroup table_group(std::vector<Column> columns);
/// Returns all columns of a table in order, with the names of parts and joints.
std::vector<Column> all_columns(const TableColumns& table, const Model& model);
/// Returns the number of parts or joints of a model for which a group repeats; 1 for Each::table.
std::size_t owner_count(const Model& model, ColumnGroup::Each each);
/// Returns the name of a part or joint.
const std::string& owner_name(const Model& model, ColumnGroup::Each each, std::size_t owner);
/// Returns a pattern with the name of a part or joint in place of "*".
std::string with_owner(std::string pattern, const std::string& owner);

}  // namespace pliant
