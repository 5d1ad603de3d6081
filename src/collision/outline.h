// Of contacts where flat faces lie on each other, those that matter: the corners of the outline.
#pragma once

#include <cstddef>
#include <vector>

#include <pliant/collision/contact.h>

namespace pliant {

/// Takes out contacts, all of one pair, from number `first` on, that lie between others with the same normal
/// and are not the deepest: what keeps those from going into each other keeps them too. size: of the smaller
/// part, m.
void keep_outline(std::vector<Contact>& contacts, std::size_t first, double size);

}  // namespace pliant
