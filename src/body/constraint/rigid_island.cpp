// The compiled function bodies of rigid_island-inl.h.
#include <pliant/body/constraint/rigid_island-inl.h>
