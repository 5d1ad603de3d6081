// The compiled bodies of group-inl.h.
#include <pliant/body/constraint/group-inl.h>
