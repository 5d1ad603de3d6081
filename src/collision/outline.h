// Reduces the contacts of two flat faces to the corners of their outline.
#pragma once

#include <cstddef>
#include <vector>

#include <pliant/collision/contact.h>

namespace pliant {

/// Removes contacts from number `first` on that are inside the outline of contacts with an equal normal and
/// are not the deepest. Non-penetration at the remaining contacts implies non-penetration at the removed
/// ones. All contacts from `first` on must belong to one pair. size: of the smaller part, m.
void keep_outline(std::vector<Contact>& contacts, std::size_t first, double size);

}  // namespace pliant
