// Reduces the contacts of two flat faces to the corners of their outline.
#pragma once

#include <cstddef>
#include <vector>

#include <pliant/collision/contact.h>

namespace pliant {

/// Removes those contacts with index >= `first` that are not corners of the convex hull of these contacts.
/// The deepest contact is kept. Nothing is removed if there are at most four contacts, if their normals
/// differ, or if their gaps are not a linear function of the position. Non-penetration at the remaining
/// contacts implies non-penetration at the removed ones. All contacts from `first` on must belong to one
/// pair. size: size of the part on a plane, or of the smaller part of a pair, m.
void keep_outline(std::vector<Contact>& contacts, std::size_t first, double size);

}  // namespace pliant
