# Writes what the program is made of, when it is installed:
#
#   NOTICES.gz          copyright notices and licences of the libraries whose headers are compiled into it, which the BSD and
#                       MIT licences ask for, as Debian has them beside the packages that it was built with; and those of
#                       the scripts in its pages, as npm has them
#   carousel.spdx.json  the same libraries and the shared ones with their versions, as a bill of materials (SPDX 2.3)
#
#   cmake -DSOURCE=... -DPROGRAM=... -DMODULES=FOLDER -DOUT=... -DVERSION=... -DCOMMIT=... -DPAGES=ON|OFF -P notices.cmake
#
# Where dpkg is missing, both name no Debian packages, and the notices say so.
cmake_minimum_required(VERSION 3.25)

# The libraries are those that script/bootstrap installs to build with: two lists.
file(STRINGS ${SOURCE}/script/bootstrap lines)
string(REGEX MATCHALL "(release|modules)=\\(([^)]*)\\)" lines "${lines}")
string(REGEX MATCHALL "[a-z0-9.+-]+-dev" headers "${lines}")
find_program(DPKG_QUERY dpkg-query)

# All that is listed here: NAME|VERSION|KIND|LICENCE|RELATION
set(parts "")
set(notices "The program carousel holds code of the libraries below. Their notices and licences follow, as their packages have them.\n")

# VERSION|DEPENDENCIES of a package of `installed`, or nothing.
function(look_up package result)
  set(${result} "" PARENT_SCOPE)
  string(FIND "${installed}" "\n${package}|" begin)
  if(begin GREATER_EQUAL 0)
    string(LENGTH "\n${package}|" skip)
    math(EXPR begin "${begin} + ${skip}")
    string(SUBSTRING "${installed}" ${begin} -1 rest)
    string(FIND "${rest}" "\n" end)
    string(SUBSTRING "${rest}" 0 ${end} line)
    set(${result} "${line}" PARENT_SCOPE)
  endif()
endfunction()
function(version_of package result)
  look_up(${package} line)
  string(REGEX REPLACE "\\|.*" "" line "${line}")
  set(${result} "${line}" PARENT_SCOPE)
endfunction()

if(DPKG_QUERY)
  execute_process(COMMAND ${DPKG_QUERY} -W -f "\n\${Package}|\${Version}|\${Depends}" OUTPUT_VARIABLE installed)
  string(APPEND installed "\n")
  # libboost-dev and others are empty packages whose headers stand in those that they depend on.
  set(all ${headers})
  foreach(package IN LISTS headers)
    look_up(${package} needs)
    string(REGEX MATCHALL "[a-z0-9.+-]+-dev" needs "${needs}")
    list(APPEND all ${needs})
  endforeach()
  list(REMOVE_DUPLICATES all)
  list(SORT all)
  foreach(package IN LISTS all)
    version_of(${package} version)
    if(version STREQUAL "" OR NOT EXISTS /usr/share/doc/${package}/copyright)
      continue()
    endif()
    list(APPEND parts "${package}|${version}|deb|NOASSERTION|STATIC_LINK")
    file(READ /usr/share/doc/${package}/copyright text)
    string(APPEND notices "\n======== ${package} ${version} ========\n\n${text}")
  endforeach()

  # Shared libraries that the program and its modules load: their packages.
  file(GLOB modules ${MODULES}/*.so)
  execute_process(COMMAND ldd ${PROGRAM} ${modules} OUTPUT_VARIABLE loaded)
  string(REGEX MATCHALL "=> /[^ \n]+\\.so[^ \n]*" loaded "${loaded}")
  list(TRANSFORM loaded REPLACE "^=> " "")
  list(REMOVE_DUPLICATES loaded)
  # Where /lib is a link to /usr/lib, packages list one name and the loader another. A pattern in their place takes seconds.
  set(named ${loaded})
  list(TRANSFORM named PREPEND /usr)
  # What alternatives provide, as LAPACK, is a link that no package owns to a file of one.
  foreach(library IN LISTS loaded)
    file(REAL_PATH ${library} real)
    list(APPEND named ${real})
  endforeach()
  execute_process(COMMAND ${DPKG_QUERY} -S ${loaded} ${named} OUTPUT_VARIABLE owners ERROR_QUIET)
  string(REGEX MATCHALL "(^|\n)[a-z0-9.+-]+" shared "${owners}")
  list(TRANSFORM shared STRIP)
  list(REMOVE_DUPLICATES shared)
  list(SORT shared)
  foreach(package IN LISTS shared)
    version_of(${package} version)
    list(APPEND parts "${package}|${version}|deb|NOASSERTION|DYNAMIC_LINK")
  endforeach()
else()
  string(APPEND notices "\nThis program was built without Debian's packages, so that the notices of its libraries are not collected here.\n")
endif()

if(PAGES)
  file(READ ${SOURCE}/web/package-lock.json lock)
  foreach(package echarts zrender tslib)
    string(JSON version GET "${lock}" packages node_modules/${package} version)
    string(JSON licence GET "${lock}" packages node_modules/${package} license)
    list(APPEND parts "${package}|${version}|npm|${licence}|CONTAINS")
    string(APPEND notices "\n======== ${package} ${version}, in the pages that the program writes ========\n")
    foreach(name LICENSE LICENSE.txt NOTICE)
      if(EXISTS ${SOURCE}/web/node_modules/${package}/${name})
        file(READ ${SOURCE}/web/node_modules/${package}/${name} text)
        string(APPEND notices "\n${text}")
      endif()
    endforeach()
  endforeach()
endif()
file(WRITE ${OUT}/NOTICES "${notices}")
execute_process(COMMAND gzip -9nf ${OUT}/NOTICES COMMAND_ERROR_IS_FATAL ANY)

set(packages "    {\"SPDXID\": \"SPDXRef-carousel\", \"name\": \"carousel\", \"versionInfo\": \"${VERSION}\", \"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false, \"licenseConcluded\": \"Apache-2.0\", \"licenseDeclared\": \"Apache-2.0\", \"copyrightText\": \"NOASSERTION\", \"comment\": \"commit ${COMMIT}\"}")
set(relations "    {\"spdxElementId\": \"SPDXRef-DOCUMENT\", \"relationshipType\": \"DESCRIBES\", \"relatedSpdxElement\": \"SPDXRef-carousel\"}")
foreach(part IN LISTS parts)
  string(REPLACE "|" ";" part "${part}")
  list(GET part 0 name)
  list(GET part 1 version)
  list(GET part 2 kind)
  list(GET part 3 licence)
  list(GET part 4 relation)
  set(purl "pkg:npm/${name}@${version}")
  if(kind STREQUAL "deb")
    string(REPLACE "+" "%2B" purl "pkg:deb/debian/${name}@${version}")
  endif()
  string(REGEX REPLACE "[^A-Za-z0-9.-]" "-" id "SPDXRef-${kind}-${name}")
  string(APPEND packages ",\n    {\"SPDXID\": \"${id}\", \"name\": \"${name}\", \"versionInfo\": \"${version}\", \"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false, \"licenseConcluded\": \"NOASSERTION\", \"licenseDeclared\": \"${licence}\", \"copyrightText\": \"NOASSERTION\", \"externalRefs\": [{\"referenceCategory\": \"PACKAGE-MANAGER\", \"referenceType\": \"purl\", \"referenceLocator\": \"${purl}\"}]}")
  string(APPEND relations ",\n    {\"spdxElementId\": \"SPDXRef-carousel\", \"relationshipType\": \"${relation}\", \"relatedSpdxElement\": \"${id}\"}")
endforeach()
# The commit's own time where git tells it, so that a build made again has the same file.
execute_process(COMMAND git -C ${SOURCE} log -1 --format=%cd --date=format-local:%Y-%m-%dT%H:%M:%SZ OUTPUT_VARIABLE created
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(created STREQUAL "")
  string(TIMESTAMP created "%Y-%m-%dT%H:%M:%SZ" UTC)
endif()
file(WRITE ${OUT}/carousel.spdx.json "{
  \"spdxVersion\": \"SPDX-2.3\",
  \"dataLicense\": \"CC0-1.0\",
  \"SPDXID\": \"SPDXRef-DOCUMENT\",
  \"name\": \"carousel-${VERSION}\",
  \"documentNamespace\": \"https://carousel.invalid/spdx/${VERSION}/${COMMIT}\",
  \"creationInfo\": {\"created\": \"${created}\", \"creators\": [\"Tool: carousel-notices\"]},
  \"packages\": [
${packages}
  ],
  \"relationships\": [
${relations}
  ]
}
")
