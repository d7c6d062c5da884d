MeshVersionFormatted 2
Dimension 3
SolAtVertices
1
1 2
0.5 1 2
End
