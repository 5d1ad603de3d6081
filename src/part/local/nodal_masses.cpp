// Compiles the function bodies of nodal_masses-inl.h once.
#include <pliant/part/local/nodal_masses-inl.h>
